"""What holds for every policy in every sequence of messages, ticks and ends of actions."""

from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import settings as effort
from hypothesis import strategies as st
from policy_models import NaivePreemption, naive_queue
from policy_runs import (
    APPROVED,
    BLOCKED,
    DONE,
    FLOWS,
    QUEUES,
    STRANGER,
    TICK,
    Run,
    gaps,
    kinds,
    often,
    queue_settings,
    settings,
    steps,
    timeout_of,
    watch_effects,
)

from example_budget import examples
from rtron.policies.state_machine import TransitionEffect
from rtron.vocabulary import Decision, PolicyName, StreamKind

OF_GRCN = (PolicyName.BLOCK, PolicyName.PREEMPTION, *QUEUES)
promptness = st.booleans()
any_settings = queue_settings() | st.builds(
    settings, st.sampled_from([PolicyName.BLOCK, PolicyName.PREEMPTION]), kinds
)


@often
@given(any_settings, steps, promptness)
def test_every_message_gets_one_final_verdict(chosen, steps, prompt):
    run = Run(chosen, prompt).play(steps)
    run.close()
    assert sorted(message.number for _, message, _ in run.left) == list(range(len(run.messages)))
    assert {v.decision for _, _, v in run.left} <= {Decision.PASS, Decision.DROP}
    assert not run.held
    assert not run.close()


@often
@given(any_settings, steps, promptness)
def test_verdicts_tell_why(chosen, steps, prompt):
    run = Run(chosen, prompt).play(steps)
    for verdict in (*run.verdicts, *(verdict for _, _, verdict in run.left)):
        assert verdict.reason
        assert verdict.policy is chosen.policy
        assert verdict.revision == chosen.revision


@often
@given(any_settings, steps, promptness)
def test_blocked_and_unknown_flows_never_pass(chosen, steps, prompt):
    passed = Run(chosen, prompt).play(steps).passed()
    assert {message.flow for _, message in passed} <= set(APPROVED)


@often
@given(any_settings, steps, promptness)
def test_refused_messages_change_nothing_for_others(chosen, steps, prompt):
    approved, gap = [], 0
    for wait, what in steps:
        gap += wait
        if what in (*APPROVED, TICK, DONE):
            approved.append((gap, what))
            gap = 0
    both = [Run(chosen, prompt).play(some).passed() for some in (steps, approved)]
    with_refused, without = [[(at, m.flow, m.arrived) for at, m in p] for p in both]
    end = sum(gap for gap, _ in approved)
    assert [one for one in with_refused if one[0] <= end] == without


@often
@given(any_settings, steps, promptness)
def test_the_named_state_tells_whether_the_output_is_owned(chosen, steps, prompt):
    run = Run(chosen, prompt)
    for step in steps:
        run.play([step])
        free = run.policy._machine.state.name in {"FREE", "WATCHING"}
        assert free is (run.policy.owner is None)


@often
@given(steps)
def test_preemption_is_what_a_naive_model_says(steps):
    chosen = settings(PolicyName.PREEMPTION)
    run, model = Run(chosen), NaivePreemption(chosen)
    for gap, what in steps:
        run.now += gap
        if what == TICK:
            run.tick()
        elif what == DONE:
            continue
        else:
            assert run.say(what) is model.verdict(what, run.now)
            if what in APPROVED:
                assert run.verdicts[-1].reason.startswith(f"{model.owner(run.now)} has the output")
        if what in (*APPROVED, TICK):
            assert run.policy.owner == model.owner(run.now)


@often
@given(queue_settings(), steps)
def test_queues_are_what_a_naive_model_says(chosen, steps):
    run, model = Run(chosen), naive_queue(chosen)
    for gap, what in steps:
        run.now += gap
        if what == TICK:
            assert run.tick() == model.tick(run.now)
        elif what == DONE:
            run.do(DONE)
            model.done(run.now)
        else:
            number = len(run.messages)
            assert run.say(what) is model.verdict(what, number, run.now)
        if what in (*APPROVED, TICK, DONE):
            assert run.policy.owner == model.owner()


@often
@given(any_settings, steps)
def test_ticks_at_the_deadlines_are_enough(chosen, steps):
    """A tick at every single nanosecond finds nothing more, and nothing earlier."""
    prompt = Run(chosen, prompt=True).play(steps)
    busy = Run(chosen, prompt=True)
    for gap, what in steps:
        for _ in range(gap):
            busy.play([(1, TICK)])
        busy.play([(0, what)])
    assert busy.left == prompt.left


@often
@given(queue_settings(), steps, promptness)
def test_nothing_passes_that_is_too_old(chosen, steps, prompt):
    for at, message in Run(chosen, prompt).play(steps).passed():
        assert at == message.arrived or at - message.arrived < chosen.max_age


@often
@given(queue_settings(), steps)
def test_queues_are_bounded(chosen, steps):
    assert Run(chosen).play(steps).most_held <= 2 * chosen.queue_size
    assert Run(chosen, prompt=True).play(steps).most_held <= chosen.queue_size + 1


@often
@given(st.sampled_from([PolicyName.PREEMPTION, PolicyName.PRIORITY_QUEUE]), steps, promptness)
def test_no_lower_message_passes_while_a_higher_flow_is_fresh(policy, steps, prompt):
    masks = policy is PolicyName.PRIORITY_QUEUE
    flows = FLOWS if masks else tuple(replace(flow, timeout=None) for flow in FLOWS)
    chosen = settings(policy, StreamKind.COMMAND, flows)
    run = Run(chosen, prompt).play([step for step in steps if step[1] != DONE])
    spoken = {}
    for at, message, became in run.story:
        if became is None:
            spoken[message.flow] = at
        elif became is Decision.PASS:
            for higher in APPROVED[APPROVED.index(message.flow) + 1 :]:
                assert at - spoken.get(higher, -100) >= timeout_of(higher, chosen)


@often
@given(st.sampled_from(QUEUES), steps, promptness)
def test_one_action_at_a_time(policy, steps, prompt):
    """Without ends, the next goes only when the one before is overdue."""
    chosen = settings(policy, StreamKind.ACTION)
    run = Run(chosen, prompt).play([step for step in steps if step[1] != DONE])
    passed = run.passed()
    limits = {f.name: f.timeout or chosen.max_hold for f in FLOWS}
    for (before, message), (after, _) in pairwise(passed):
        assert after - before >= min(limits[message.flow], chosen.max_hold)


@often
@given(steps, promptness)
def test_actions_go_in_order_of_arrival(steps, prompt):
    chosen = settings(PolicyName.FIFO_QUEUE, StreamKind.ACTION)
    numbers = [message.number for _, message in Run(chosen, prompt).play(steps).passed()]
    assert numbers == sorted(numbers)


@often
@given(st.sampled_from(QUEUES), steps, promptness)
def test_the_commands_of_a_flow_never_go_back(policy, steps, prompt):
    run = Run(settings(policy, StreamKind.COMMAND), prompt).play(steps)
    for flow in APPROVED:
        numbers = [message.number for _, message in run.passed() if message.flow == flow]
        assert numbers == sorted(numbers)


@pytest.mark.parametrize("policy", OF_GRCN)
@given(flow=st.sampled_from(APPROVED), gap=gaps)
@effort(max_examples=examples(50), deadline=None)
def test_the_first_message_passes_whoever_could_go_before(policy, flow, gap):
    """A flow that has never spoken masks nobody, however high and however early."""
    assert Run(settings(policy)).play([(gap, flow)]).passed()


@pytest.mark.parametrize("policy", OF_GRCN)
def test_a_pass_builds_no_verdict(policy):
    run = Run(settings(policy))
    run.play([(1, "high"), (1, "high")])
    assert run.verdicts[0] is run.verdicts[1]


@often
@given(any_settings, steps, promptness, st.sampled_from([*APPROVED, BLOCKED, STRANGER]))
def test_a_refusal_is_what_any_message_would_be_dropped_with(chosen, steps, prompt, flow):
    run = Run(chosen, prompt).play(steps)
    refusal = run.policy.refusal(flow, run.now)
    assert (refusal is None) is (flow in APPROVED)
    if refusal is not None:
        assert refusal == run.policy.verdict(flow, "any", run.now)
        assert refusal.decision is Decision.DROP


@often
@given(any_settings, steps)
def test_what_is_done_is_the_effect_in_the_table(chosen, steps):
    run = Run(chosen)
    effects = watch_effects(run.policy)
    for gap, what in steps:
        effects.clear()
        run.now += gap
        if what in (TICK, DONE):
            run.do(what)
            assert set(effects) <= {TransitionEffect.NOTHING, TransitionEffect.RELEASE}
        else:
            decision = run.say(what)
            assert effects[-1] is TransitionEffect[decision.name]
            assert set(effects[:-1]) <= {TransitionEffect.NOTHING}


@often
@given(queue_settings(), steps)
def test_each_message_that_a_tick_lets_go_is_a_step_in_the_table(chosen, steps):
    run = Run(chosen)
    effects = watch_effects(run.policy)
    run.play(steps)
    effects.clear()
    gone = [decision for _, decision in run.tick()]
    assert effects.count(TransitionEffect.RELEASE) == gone.count(Decision.PASS)
