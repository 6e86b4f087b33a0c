import pytest
from policy_runs import BLOCKED, HIGH, LOW, MIDDLE, RELEASE_AFTER, TICK, Run, settings

from rtron.vocabulary import Decision, PolicyName

PASS, DROP = Decision.PASS, Decision.DROP


def start(**others):
    return Run(settings(PolicyName.PREEMPTION, **others))


@pytest.mark.parametrize(
    ("silence", "decision"),
    [(0, DROP), (RELEASE_AFTER - 1, DROP), (RELEASE_AFTER, PASS), (RELEASE_AFTER + 1, PASS)],
)
def test_the_owner_is_fresh_until_release_after(silence, decision):
    run = start().play([(5, HIGH)])
    run.wait(silence)
    assert run.say(LOW) is decision


def test_every_message_of_the_owner_renews_it():
    run = start().play([(5, HIGH), (RELEASE_AFTER - 1, HIGH), (RELEASE_AFTER - 1, LOW)])
    assert [v.decision for v in run.verdicts] == [PASS, PASS, DROP]
    assert run.verdicts[2].reason == "high has the output (priority 3)"


def test_a_higher_flow_takes_over_at_once_and_at_the_same_time_stamp():
    run = start().play([(5, LOW), (0, MIDDLE), (0, HIGH), (0, MIDDLE), (0, LOW)])
    assert [v.decision for v in run.verdicts] == [PASS, PASS, PASS, DROP, DROP]


def test_the_reason_follows_the_owner():
    run = start().play([(5, MIDDLE), (0, LOW), (0, HIGH), (0, LOW), (0, LOW)])
    assert run.verdicts[1].reason == "middle has the output (priority 2)"
    assert run.verdicts[3].reason == "high has the output (priority 3)"
    assert run.verdicts[3] is run.verdicts[4]


def test_a_flow_that_never_spoke_masks_nobody_at_time_zero():
    assert start().say(LOW) is PASS


def test_a_blocked_flow_masks_nobody_however_much_it_speaks():
    run = start().play([(1, BLOCKED), (1, LOW), (1, BLOCKED), (1, LOW)])
    assert [v.decision for v in run.verdicts] == [DROP, PASS, DROP, PASS]
    assert run.policy.owner == LOW


def test_the_deadline_is_the_owners_silence():
    run = start().play([(5, HIGH), (2, LOW)])
    assert run.policy.deadline() == 5 + RELEASE_AFTER


def test_a_tick_at_the_deadline_finds_the_next_owner_and_then_none():
    run = start().play([(5, HIGH), (2, LOW), (RELEASE_AFTER - 3, TICK)])
    assert run.policy.owner == HIGH
    assert run.play([(1, TICK)]).policy.owner == LOW
    assert run.policy.deadline() == 7 + RELEASE_AFTER
    assert run.play([(2, TICK)]).policy.owner is None
    assert run.policy.deadline() is None


def test_an_idle_output_stays_idle():
    run = start().play([(5, TICK), (5, TICK)])
    assert run.policy.owner is None


def test_without_release_after_nobody_masks():
    run = start(release_after=0).play([(5, HIGH), (0, LOW), (0, HIGH)])
    assert [v.decision for v in run.verdicts] == [PASS] * 3
    assert run.play([(0, TICK)]).policy.owner is None
