"""Who spoke when, as far as others still wait for it."""

import pytest
from policy_runs import FLOWS, HIGH, LOW, MIDDLE, RELEASE_AFTER, Run, settings

from rtron.policies import build_policy
from rtron.policies.policy import ImmediatePolicy
from rtron.vocabulary import PolicyName, StreamKind, Velocity


def test_preemption_knows_the_fresh_flows():
    run = Run(settings(PolicyName.PREEMPTION))
    for flow in (HIGH, LOW):
        run.say(flow)
    assert run.policy.last_message_times(run.now) == {HIGH: run.now, LOW: run.now}
    assert run.policy.last_message_times(run.now + RELEASE_AFTER) == {}


@pytest.mark.parametrize("policy", [PolicyName.PRIORITY_QUEUE, PolicyName.FIFO_QUEUE])
def test_a_queue_of_commands_knows_who_has_the_turn_and_who_waits(policy):
    run = Run(settings(policy))
    for flow in (HIGH, LOW):
        run.say(flow)
    assert run.policy.last_message_times(run.now) == {HIGH: run.now, LOW: run.now}
    assert run.policy.owner == HIGH


def test_of_actions_only_the_one_in_progress_counts():
    run = Run(settings(PolicyName.FIFO_QUEUE, StreamKind.ACTION, max_age=100))
    for flow in (HIGH, LOW):
        run.say(flow)
    assert run.policy.last_message_times(run.now) == {HIGH: run.now}


def test_a_limit_knows_the_fresh_flows_where_they_have_an_order():
    policy = build_policy(settings(PolicyName.CONSTRAIN))
    policy.verdict(MIDDLE, Velocity((0.1,)), 1)
    assert policy.last_message_times(1) == {MIDDLE: 1}
    alone = tuple(flow for flow in FLOWS if flow.name == LOW)
    policy = build_policy(settings(PolicyName.CONSTRAIN, flows=alone))
    policy.verdict(LOW, Velocity((0.1,)), 1)
    assert policy.last_message_times(1) == {}


def test_nobody_waits_for_anybody_without_an_order():
    assert ImmediatePolicy().last_message_times(0) == {}
