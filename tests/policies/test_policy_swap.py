"""A policy in the place of another one: what it takes over, and of whom it does not know."""

import pytest
from policy_runs import DONE, FLOWS, HIGH, LOW, STRANGER, TICK, Run, settings

from rtron.policies import build_policy
from rtron.vocabulary import Decision, PolicyName, StreamKind

POLICIES = (
    PolicyName.BLOCK,
    PolicyName.PREEMPTION,
    PolicyName.FIFO_QUEUE,
    PolicyName.PRIORITY_QUEUE,
)
HIGH_ALONE = tuple(flow for flow in FLOWS if flow.name == HIGH)


def goals(policy, flows=FLOWS, kind=StreamKind.ACTION):
    return settings(policy, kind, flows)


@pytest.mark.parametrize("policy", POLICIES)
def test_who_is_refused_is_known_before_he_speaks(policy):
    built = build_policy(goals(policy))
    assert built.refusal(LOW, 0) is None
    assert built.refusal(STRANGER, 0).decision is Decision.DROP


@pytest.mark.parametrize("after", POLICIES)
@pytest.mark.parametrize("before", POLICIES)
def test_nobody_who_is_not_known_any_more_speaks_or_waits(before, after):
    run = Run(goals(before)).play([(1, HIGH), (1, LOW)])
    run.swap(goals(after, HIGH_ALONE))
    assert run.held == set()
    assert run.say(LOW) is Decision.DROP


@pytest.mark.parametrize("kind", [StreamKind.ACTION, StreamKind.COMMAND])
@pytest.mark.parametrize("after", POLICIES)
@pytest.mark.parametrize("before", POLICIES)
def test_after_silence_nothing_is_taken_over(before, after, kind):
    run = Run(goals(before, kind=kind))
    run.swap(goals(after, kind=kind))
    assert not run.policy.export_state(run.now).last_message_times
    assert run.say(LOW) is Decision.PASS


@pytest.mark.parametrize("policy", [PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE])
def test_a_goal_that_is_done_bars_nobody_after_the_swap(policy):
    run = Run(goals(policy)).play([(1, HIGH), (1, DONE), (1, TICK)])
    run.swap(goals(policy))
    assert run.policy.export_state(run.now).lease is None
    assert run.say(LOW) is Decision.PASS
