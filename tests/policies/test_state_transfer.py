"""A policy that takes the place of another one: nothing is lost, forgotten, or let slip in."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_models import NaivePreemption
from policy_runs import (
    APPROVED,
    BLOCKED,
    DONE,
    FLOWS,
    HIGH,
    LIMITS,
    LOW,
    MAX_AGE,
    MAX_HOLD,
    MIDDLE,
    QUEUES,
    RELEASE_AFTER,
    Run,
    gaps,
    happenings,
    kinds,
    often,
    queue_settings,
    settings,
)

from rtron.errors import PlanError
from rtron.policies import POLICIES, FrameMonitors, build_policy
from rtron.policies.mission.event_bits import EventBits
from rtron.policies.mission.rule_block import RuleBlock
from rtron.policies.mission.rule_status import MissionMonitor
from rtron.policies.policy import ImmediatePolicy
from rtron.policies.state_transfer import PolicyState, VelocityRequest
from rtron.vocabulary import Decision, Flow, PolicyName, StageRule, StreamKind, Velocity

OF_GRCN = (PolicyName.BLOCK, PolicyName.PREEMPTION, *QUEUES)
COMMAND, ACTION = StreamKind.COMMAND, StreamKind.ACTION
PASS, HOLD, DROP = Decision.PASS, Decision.HOLD, Decision.DROP


@st.composite
def any_settings(draw, kind):
    """Return settings of any policy of a GRCN: other priorities, bits, timeouts and durations."""
    priorities = draw(st.permutations([1, 2, 3, 9]))
    chosen = tuple(
        replace(
            flow,
            priority=priority,
            block=draw(st.sampled_from([False, False, True])),
            timeout=draw(st.none() | st.sampled_from([0, 1, 7, 16])),
        )
        for flow, priority in zip(FLOWS, priorities, strict=True)
    )
    return settings(
        draw(st.sampled_from(OF_GRCN)),
        kind,
        chosen,
        release_after=draw(st.sampled_from([1, RELEASE_AFTER, 30])),
        max_age=draw(st.sampled_from([1, MAX_AGE, 100])),
        max_hold=draw(st.sampled_from([1, MAX_HOLD, 1000])),
        queue_size=3,
        revision=draw(st.integers(0, 9)),
    )


@st.composite
def swapped_runs(draw):
    """Return first settings, and steps some of which put others in force."""
    kind = draw(kinds)
    step = st.tuples(gaps, happenings) | st.tuples(gaps, any_settings(kind))
    return draw(any_settings(kind)), draw(st.lists(step, min_size=4, max_size=30))


def blocks(chosen, flow):
    return any(each.name == flow and each.block for each in chosen.flows)


@often
@given(swapped_runs(), st.booleans())
def test_every_message_leaves_once_whatever_is_swapped(steps, prompt):
    first, steps = steps
    run = Run(first, prompt).play(steps)
    run.close()
    assert sorted(message.number for _, message, _ in run.left) == list(range(len(run.messages)))
    assert not run.held
    assert not run.close()


@often
@given(swapped_runs(), st.booleans())
def test_nothing_passes_that_settings_forbid_before_or_after(steps, prompt):
    """Also not what waited while its flow was blocked for a moment."""
    first, steps = steps
    run = Run(first, prompt)
    in_force, left = [(0, first)], 0
    for gap, what in steps:
        run.wait(gap)
        left = check_what_left(run, in_force, left)
        run.play([(0, what)])
        if not isinstance(what, str):
            in_force.append((len(run.messages), what))
        left = check_what_left(run, in_force, left)


def check_what_left(run, in_force, left):
    """Look at what left since the last call, by the settings from its arrival until now."""
    for at, message, verdict in run.left[left:]:
        if verdict.decision is PASS:
            since = [chosen for number, chosen in in_force if number > message.number]
            arrived = [chosen for number, chosen in in_force if number <= message.number][-1]
            assert not any(blocks(chosen, message.flow) for chosen in (arrived, *since))
            assert at == message.arrived or at - message.arrived < run.settings.max_age
    return len(run.left)


@often
@given(swapped_runs())
def test_verdicts_after_a_swap_are_by_the_new_settings(steps):
    first, steps = steps
    run = Run(first, prompt=True)
    for step in steps:
        said = len(run.verdicts)
        run.play([step])
        for verdict in run.verdicts[said:]:
            assert verdict.revision == run.settings.revision
            assert verdict.policy is run.settings.policy


@often
@given(swapped_runs())
def test_the_named_state_tells_whether_the_output_is_owned_after_a_swap(steps):
    first, steps = steps
    run = Run(first)
    for step in steps:
        run.play([step])
        free = run.policy._machine.state.name in {"FREE", "WATCHING"}
        assert free is (run.policy.owner is None)


@st.composite
def same_runs(draw):
    chosen = draw(queue_settings() | any_settings(draw(kinds)))
    step = st.tuples(gaps, happenings)
    return chosen, draw(st.lists(step, max_size=30)), draw(st.sets(st.integers(0, 29)))


@often
@given(same_runs())
def test_the_same_settings_again_change_nothing(same):
    chosen, steps, swaps = same
    plain = Run(chosen, prompt=True).play(steps)
    swapped = Run(chosen, prompt=True)
    for at, step in enumerate(steps):
        if at in swaps:
            swapped.play([(0, chosen)])
        swapped.play([step])
    assert swapped.left == plain.left
    assert swapped.policy.owner == plain.policy.owner
    assert swapped.policy.deadline() == plain.policy.deadline()


@often
@given(
    st.lists(
        st.tuples(gaps, happenings)
        | st.tuples(gaps, st.permutations([1, 2, 3, 9]))
        | st.tuples(gaps, st.sampled_from([1, 5, RELEASE_AFTER, 40])),
        min_size=4,
        max_size=40,
    )
)
def test_no_lower_flow_slips_in_when_priorities_or_release_after_change(steps):
    chosen = settings(PolicyName.PREEMPTION)
    run, model = Run(chosen), NaivePreemption(chosen)
    for gap, what in steps:
        run.now += gap
        if isinstance(what, str):
            if what in APPROVED:
                assert run.say(what) is model.verdict(what, run.now)
            continue
        model.spoken = {f: at for f, at in model.spoken.items() if run.now - at < model.limit}
        chosen = _changed(chosen, what)
        run.swap(chosen)
        model.limit = chosen.release_after
        model.priority = {flow.name: flow.priority for flow in chosen.flows if not flow.block}
        assert run.policy.owner == model.owner(run.now)


def _changed(chosen, what):
    if isinstance(what, int):
        return replace(chosen, release_after=what)
    flows = zip(chosen.flows, what, strict=True)
    return replace(chosen, flows=tuple(replace(f, priority=priority) for f, priority in flows))


@pytest.mark.parametrize("before", [PolicyName.BLOCK, PolicyName.PREEMPTION, *QUEUES])
def test_whoever_is_fresh_goes_before_lower_flows_under_preemption(before):
    run = Run(settings(before))
    run.say(HIGH)
    run.now = RELEASE_AFTER - 1
    run.swap(settings(PolicyName.PREEMPTION))
    assert run.policy.owner == HIGH
    assert run.say(LOW) is DROP
    run.now += 1
    assert run.say(LOW) is PASS


@pytest.mark.parametrize("before", QUEUES)
def test_who_only_waited_is_fresh_too(before):
    flows = tuple(replace(flow, priority=-flow.priority) for flow in FLOWS)
    run = Run(settings(before, flows=flows))
    run.say(LOW)
    assert run.say(HIGH) is HOLD
    run.swap(settings(PolicyName.PREEMPTION))
    assert [verdict.reason for _, message, verdict in run.left if message.flow == HIGH] == [
        "the policy has changed, and messages wait no more"
    ]
    assert run.policy.owner == HIGH
    assert run.say(LOW) is DROP


def test_a_higher_flow_masks_lower_ones_under_priority_queue_as_it_did_before():
    run = Run(settings(PolicyName.PREEMPTION))
    run.say(HIGH)
    run.now = 15
    run.swap(settings(PolicyName.PRIORITY_QUEUE))
    assert run.say(LOW) is PASS  # `release_after` was over: it was not fresh any more
    run = Run(settings(PolicyName.PREEMPTION))
    run.say(HIGH)
    run.now = RELEASE_AFTER - 1
    run.swap(settings(PolicyName.PRIORITY_QUEUE))
    assert run.policy.owner == HIGH
    run.now = 15
    assert run.say(LOW) is HOLD
    run.now = 16
    assert run.tick() == [(1, PASS)]


@pytest.mark.parametrize("before", OF_GRCN)
@pytest.mark.parametrize("after", QUEUES)
def test_an_action_in_progress_stays_so_counted_from_its_begin(before, after):
    run = Run(settings(before, ACTION, max_hold=1000))
    run.say(LOW)
    run.now = 10
    run.swap(settings(after, ACTION, max_hold=30))
    assert run.policy.owner == LOW
    assert run.say(HIGH) is HOLD
    assert run.policy.deadline() == 10 + MAX_AGE
    run.now = 29
    run.swap(settings(after, ACTION, max_hold=30, max_age=100))
    run.say(HIGH)
    assert run.policy.deadline() == 30
    run.now = 30
    assert run.tick()[-1] == (2, PASS)


@pytest.mark.parametrize("before", OF_GRCN)
@pytest.mark.parametrize("after", QUEUES)
def test_an_action_that_is_done_is_not_in_progress_after_the_swap(before, after):
    run = Run(settings(before, ACTION))
    run.say(LOW)
    run.do(DONE)
    run.swap(settings(after, ACTION))
    assert run.policy.owner is None
    assert run.say(HIGH) is PASS


def test_an_action_whose_flow_is_blocked_now_is_in_progress_until_it_is_done():
    run = Run(settings(PolicyName.FIFO_QUEUE, ACTION))
    run.say(LOW)
    blocked = tuple(replace(flow, block=flow.name == LOW) for flow in FLOWS)
    run.swap(settings(PolicyName.FIFO_QUEUE, ACTION, blocked))
    assert run.policy.owner == LOW
    assert run.say(HIGH) is HOLD
    run.do(DONE)
    assert run.tick() == [(1, PASS)]


@pytest.mark.parametrize("policy", QUEUES)
def test_a_command_s_turn_ends_when_its_flow_is_blocked(policy):
    run = Run(settings(policy))
    run.say(HIGH)
    assert run.say(LOW) is HOLD
    blocked = tuple(replace(flow, block=flow.name == HIGH) for flow in FLOWS)
    run.swap(settings(policy, flows=blocked))
    assert run.policy.owner is None
    assert run.policy.deadline() == run.now
    assert run.tick() == [(1, PASS)]


@pytest.mark.parametrize("kind", StreamKind)
def test_who_waited_first_goes_first_under_fifo_and_the_highest_under_priority(kind):
    for policy, last in ((PolicyName.FIFO_QUEUE, 2), (PolicyName.PRIORITY_QUEUE, 3)):
        run = Run(settings(PolicyName.FIFO_QUEUE, kind, release_after=100, max_age=1000))
        for flow in (MIDDLE, "blocked", LOW, HIGH):
            run.now += 1
            run.say(flow)
        run.swap(settings(policy, kind, max_age=1000, release_after=100))
        run.do(DONE)
        run.now = 200
        assert next(number for number, decision in run.tick() if decision is PASS) == last


def test_a_refreshed_command_keeps_its_place_and_its_age():
    run = Run(settings(PolicyName.FIFO_QUEUE, release_after=100))
    for gap, flow in ((0, HIGH), (1, LOW), (1, MIDDLE), (1, LOW)):
        run.now += gap
        run.say(flow)
    run.swap(settings(PolicyName.FIFO_QUEUE, release_after=100))
    assert run.policy.deadline() == 2 + MAX_AGE
    run.now = 2 + MAX_AGE
    assert run.tick() == [(2, DROP)]
    assert run.policy.deadline() == 3 + MAX_AGE


def test_what_waits_too_long_under_the_new_settings_is_dropped():
    run = Run(settings(PolicyName.FIFO_QUEUE, ACTION, max_age=100))
    run.say(LOW)
    run.say(HIGH)
    run.now = 20
    run.swap(settings(PolicyName.FIFO_QUEUE, ACTION, max_age=20))
    assert run.policy.deadline() == 20
    assert run.tick() == [(1, DROP)]


def test_a_message_that_moved_can_be_withdrawn():
    run = Run(settings(PolicyName.FIFO_QUEUE, ACTION))
    run.say(LOW)
    run.say(HIGH)
    run.swap(settings(PolicyName.PRIORITY_QUEUE, ACTION))
    run.policy.withdraw(run.messages[1], "cancelled")
    assert [verdict.reason for _, _, verdict in run.left] == ["low has the output"]
    run.tick()
    assert run.left[-1][2].reason == "cancelled"


@pytest.mark.parametrize("policy", POLICIES)
def test_verdicts_that_were_given_before_are_given_anew_for_a_revision(policy):
    made = build_policy(
        settings(policy, flows=(*FLOWS, Flow(name="other", publisher="/o", priority=5)))
    )
    now = 0

    def said():
        nonlocal now
        now += 1
        message = Velocity((2.0,), (0.0,))
        flows = (HIGH, LOW, BLOCKED, "unapproved", "nobody")
        return {made.verdict(flow, message, now).revision for flow in flows}

    assert said() == said() == {0}
    made.revise(7)
    assert said() == said() == {7}


def test_a_mission_s_verdicts_are_given_anew_for_a_revision():
    made = RuleBlock(settings(PolicyName.BLOCK), MissionMonitor(EventBits()), lambda message: {})
    flows = (HIGH, BLOCKED)
    assert {made.verdict(flow, "", 0).revision for flow in flows} == {0}
    made.revise(3)
    assert {made.verdict(flow, "", 0).revision for flow in flows} == {3}


def test_a_policy_without_a_memory_carries_nothing():
    assert ImmediatePolicy().export_state(0) == PolicyState()
    assert ImmediatePolicy().restore_state(PolicyState(), 0) == ()


FAST = Velocity((2.0,), (1.0,))


def limited(speed, flows=FLOWS):
    made = build_policy(settings(PolicyName.CONSTRAIN, flows=flows, max_vel_limit=speed))
    made.reissues = True
    return made


def swapped(before, after, now=0):
    assert after.restore_state(before.export_state(now), now) == ()
    return [(release.message.speed, release.restores) for release in after.tick(now)]


def test_a_lowered_limit_takes_effect_on_what_was_asked_for_last():
    before, after = limited(3.0), limited(0.5)
    before.verdict(HIGH, FAST, 0)
    assert swapped(before, after) == [(pytest.approx(0.5), False)]
    assert after.tick(1) == ()


def test_a_raised_limit_gives_back_what_was_asked_for_and_no_more():
    before, middle, after = limited(0.5), limited(1.0), limited(9.0)
    before.verdict(HIGH, FAST, 0)
    assert swapped(before, middle) == [(pytest.approx(1.0), True)]
    assert swapped(middle, after) == [(FAST.speed, True)]


def test_the_same_limit_says_nothing_again():
    before, after = limited(0.5), limited(0.5)
    before.verdict(HIGH, FAST, 0)
    assert swapped(before, after) == []


def test_a_limit_that_was_not_asked_for_anything_says_nothing():
    assert swapped(limited(3.0), limited(0.5)) == []


def test_a_flow_that_is_blocked_now_gets_nothing_back_but_is_held_to_a_lower_limit():
    blocked = tuple(replace(flow, block=flow.name == HIGH) for flow in FLOWS)
    before, middle, after = limited(1.0), limited(9.0, blocked), limited(0.5, blocked)
    before.verdict(HIGH, FAST, 0)
    assert swapped(before, middle) == []
    assert swapped(middle, after) == [(pytest.approx(0.5), False)]
    assert swapped(after, limited(9.0)) == [(pytest.approx(1.0), True)]


def test_who_spoke_without_an_order_is_fresh_in_the_order_that_comes():
    alike = tuple(replace(flow, priority=0) for flow in FLOWS)
    before = build_policy(settings(PolicyName.CONSTRAIN, flows=alike))
    before.verdict(HIGH, FAST, 0)
    after = build_policy(settings(PolicyName.CONSTRAIN))
    swapped(before, after, RELEASE_AFTER - 1)
    assert after.verdict(LOW, FAST, RELEASE_AFTER - 1).decision is DROP
    assert after.verdict(LOW, FAST, RELEASE_AFTER).decision is Decision.MODIFY


def test_who_spoke_before_an_order_was_lifted_is_fresh_when_it_comes_back():
    alike = tuple(replace(flow, priority=0) for flow in FLOWS)
    before = build_policy(settings(PolicyName.CONSTRAIN))
    before.verdict(HIGH, FAST, 0)
    middle, after = (build_policy(settings(PolicyName.CONSTRAIN, flows=f)) for f in (alike, FLOWS))
    swapped(before, middle, 1)
    assert middle.verdict(LOW, FAST, 1).decision is Decision.MODIFY
    swapped(middle, after, 2)
    assert after.verdict(LOW, FAST, 2).decision is DROP


def test_who_spoke_in_an_order_is_fresh_when_the_order_changes():
    upside_down = tuple(replace(flow, priority=-flow.priority) for flow in FLOWS)
    before = build_policy(settings(PolicyName.CONSTRAIN, flows=upside_down))
    before.verdict(HIGH, FAST, 0)
    after = build_policy(settings(PolicyName.CONSTRAIN))
    swapped(before, after, 1)
    assert after.owner is None or after.owner == HIGH
    assert after.verdict(LOW, FAST, 1).decision is DROP


@pytest.mark.parametrize("policy", LIMITS)
def test_any_limit_takes_over_from_any_other(policy):
    before = build_policy(settings(policy), FrameMonitors())
    after = build_policy(settings(PolicyName.CONSTRAIN, max_vel_limit=0.2))
    after.reissues = before.reissues = True
    before.verdict(HIGH, FAST, 0)
    [(speed, _)] = swapped(before, after)
    assert speed == pytest.approx(0.2)


def test_a_limit_can_be_told_what_was_asked_for_under_no_limit():
    after = limited(0.5)
    after.restore_state(PolicyState(velocity_request=VelocityRequest(HIGH, FAST, FAST)), 0)
    [release] = after.tick(0)
    assert release.message.speed == pytest.approx(0.5)


@pytest.mark.parametrize("policy", [PolicyName.PREEMPTION, PolicyName.PRIORITY_QUEUE])
def test_equal_priorities_are_refused_before_anything_changes(policy):
    alike = tuple(replace(flow, priority=0) for flow in FLOWS)
    with pytest.raises(PlanError, match="same priority"):
        build_policy(settings(policy, flows=alike))


def test_a_rule_block_is_made_for_the_standings_that_will_be():
    mission = MissionMonitor(EventBits())
    rules = (StageRule(name="new", blocked_flows=frozenset({HIGH})),)
    with pytest.raises(KeyError):
        RuleBlock(settings(PolicyName.BLOCK, rules=rules), mission, lambda message: {})
