"""A flow that has lost its publisher is silent at once, whatever the policy would wait for."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_models import NaivePreemption, naive_queue
from policy_runs import (
    APPROVED,
    BLOCKED,
    FLOWS,
    HIGH,
    LOW,
    MAX_HOLD,
    MIDDLE,
    QUEUES,
    RELEASE_AFTER,
    STRANGER,
    Run,
    often,
    settings,
)

from rtron.policies import build_policy
from rtron.policies.policy import ImmediatePolicy
from rtron.vocabulary import Decision, PolicyName, StreamKind, Velocity

PASS, HOLD, DROP = Decision.PASS, Decision.HOLD, Decision.DROP
GONE = "gone"
gaps = st.sampled_from([0, 0, 1, 6, 7, RELEASE_AFTER - 1, RELEASE_AFTER, 16, MAX_HOLD])
happenings = st.sampled_from([*APPROVED, BLOCKED, STRANGER]) | st.tuples(
    st.just(GONE), st.sampled_from([*APPROVED, BLOCKED, STRANGER])
)
stories = st.lists(st.tuples(gaps, happenings), max_size=30)


@often
@given(stories)
def test_preemption_forgets_as_a_naive_model_does(story):
    chosen = settings(PolicyName.PREEMPTION)
    policy, model, now = build_policy(chosen), NaivePreemption(chosen), 0
    for gap, what in story:
        now += gap
        if isinstance(what, tuple):
            policy.forget_flow(what[1], now)
            model.spoken.pop(what[1], None)
            assert policy.owner == model.owner(now)
        else:
            assert policy.verdict(what, object(), now).decision is model.verdict(what, now)


def forget(model, flow, now):
    """Let a naive queue of commands forget a flow."""
    model.pass_time(now)
    model.drop([each for each in model.waiting if each[0] == flow])
    if hasattr(model, "spoken"):
        model.spoken.pop(flow, None)
    elif model.turn == flow:
        model.turn = None
    model.lapse(now)


@often
@given(st.sampled_from(QUEUES), stories)
def test_a_queue_of_commands_forgets_as_a_naive_model_does(policy, story):
    chosen = settings(policy)
    queue, model, now = build_policy(chosen), naive_queue(chosen), 0
    for number, (gap, what) in enumerate(story):
        now += gap
        if isinstance(what, tuple):
            queue.forget_flow(what[1], now)
            forget(model, what[1], now)
        else:
            message = (number, what)
            assert queue.verdict(what, message, now).decision is model.verdict(what, message, now)
        left = [(each.message, each.verdict.decision) for each in queue.tick(now)]
        assert sorted(left) == sorted(model.tick(now))
        assert queue.owner == model.owner()


@pytest.mark.parametrize("policy", QUEUES)
def test_what_it_wanted_is_dropped_with_the_reason(policy):
    run = Run(settings(policy))
    run.say(HIGH)
    assert run.say(LOW) is HOLD
    run.policy.forget_flow(LOW, run.now)
    (release,) = run.policy.tick(run.now)
    assert (release.verdict.decision, release.verdict.reason) == (
        DROP,
        "low has lost its publisher",
    )


@pytest.mark.parametrize("policy", QUEUES)
def test_who_had_the_turn_gives_it_to_who_waits(policy):
    run = Run(settings(policy))
    run.say(HIGH)
    assert run.say(LOW) is HOLD
    run.policy.forget_flow(HIGH, run.now)
    assert [each.verdict.decision for each in run.policy.tick(run.now)] == [PASS]
    assert run.policy.owner == LOW


@pytest.mark.parametrize("policy", QUEUES)
@pytest.mark.parametrize("kind", [StreamKind.ACTION, StreamKind.STATE])
def test_goals_stay_in_progress_and_in_the_queue(policy, kind):
    run = Run(settings(policy, kind, max_age=100))
    run.say(HIGH)
    assert run.say(LOW) is HOLD
    for flow in (HIGH, LOW):
        run.policy.forget_flow(flow, run.now)
    assert run.policy.tick(run.now) == []
    assert run.policy.owner == HIGH
    run.policy.observe_done(run.now)
    assert [each.verdict.decision for each in run.policy.tick(run.now)] == [PASS]


def test_a_limit_with_an_order_forgets_who_was_higher():
    policy = build_policy(settings(PolicyName.CONSTRAIN))
    slow = Velocity((0.1,))
    assert policy.verdict(HIGH, slow, 0).decision is PASS
    assert policy.verdict(MIDDLE, slow, 0).decision is DROP
    policy.forget_flow(HIGH, 1)
    assert policy.verdict(MIDDLE, slow, 1).decision is PASS


def test_a_limit_without_an_order_has_nothing_to_forget():
    flows = tuple(flow for flow in FLOWS if flow.name == LOW)
    policy = build_policy(settings(PolicyName.CONSTRAIN, flows=flows))
    policy.forget_flow(LOW, 0)
    assert policy.verdict(LOW, Velocity((0.1,)), 0).decision is PASS


def test_who_remembers_nobody_forgets_nobody():
    assert ImmediatePolicy().forget_flow(LOW, 0) is None
