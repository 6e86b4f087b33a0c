import pytest
from policy_runs import (
    BLOCKED,
    DONE,
    HIGH,
    LOW,
    MAX_AGE,
    MAX_HOLD,
    MIDDLE,
    RELEASE_AFTER,
    TICK,
    Run,
    settings,
)

from rtron.policies import build_policy
from rtron.vocabulary import SECOND, Decision, Flow, PolicyName, StreamKind

PASS, HOLD, DROP = Decision.PASS, Decision.HOLD, Decision.DROP
MIDDLE_TIMEOUT, HIGH_TIMEOUT = 7, 16


def start(kind, **others):
    return Run(settings(PolicyName.PRIORITY_QUEUE, kind, **{"max_age": 1000, **others}))


def actions(**others):
    return start(StreamKind.ACTION, **others)


def commands(**others):
    return start(StreamKind.COMMAND, **others)


def test_the_papers_example():
    """Without a command of flow3 for 0.2 s, that of flow2, the second priority, goes."""
    policy = build_policy(
        settings(
            PolicyName.PRIORITY_QUEUE,
            flows=(
                Flow(name="flow1", publisher="/navigation_control", priority=1),
                Flow(name="flow2", publisher="/tele_operation", priority=2),
                Flow(name="flow3", publisher="/safe_control", priority=3, timeout=SECOND // 5),
            ),
            release_after=SECOND // 2,
            max_age=SECOND // 2,
        )
    )
    policy.verdict("flow3", "stop", 0)
    assert policy.verdict("flow1", "forward", SECOND // 10).decision is HOLD
    assert policy.verdict("flow2", "left", SECOND // 10).decision is HOLD
    assert policy.tick(SECOND // 5 - 1) == []
    (release,) = policy.tick(SECOND // 5)
    assert (release.message, release.verdict.decision) == ("left", PASS)
    assert policy.owner == "flow2"


@pytest.mark.parametrize("gap", [0, 1, HIGH_TIMEOUT - 1])
def test_a_command_waits_while_a_higher_flow_is_fresh(gap):
    run = commands().play([(5, HIGH), (gap, LOW)])
    assert run.verdicts[1].decision is HOLD
    assert run.verdicts[1].reason == "high has the output (priority 3)"
    assert run.policy.deadline() == 5 + HIGH_TIMEOUT


@pytest.mark.parametrize("gap", [HIGH_TIMEOUT, HIGH_TIMEOUT + 1])
def test_a_command_passes_when_the_higher_flow_is_silent(gap):
    assert commands().play([(5, HIGH), (gap, LOW)]).verdicts[1].decision is PASS


def test_a_flow_without_time_masks_nobody():
    flows = (
        Flow(name=LOW, publisher="/low"),
        Flow(name=HIGH, publisher="/h", priority=1, timeout=0),
    )
    assert commands(flows=flows).play([(5, HIGH), (0, LOW)]).verdicts[1].decision is PASS


def test_each_higher_flow_counts_with_its_own_timeout():
    run = commands().play([(0, HIGH), (HIGH_TIMEOUT - 1, MIDDLE), (0, LOW), (1, TICK)])
    assert [m.number for _, m in run.passed()] == [0, 1]
    run.play([(MIDDLE_TIMEOUT - 1, TICK)])
    assert len(run.passed()) == 2
    run.play([(1, TICK)])
    assert [m.number for _, m in run.passed()] == [0, 1, 2]


def test_a_command_that_goes_counts_as_spoken():
    run = commands().play([(0, HIGH), (1, MIDDLE), (0, LOW), (HIGH_TIMEOUT - 1, TICK)])
    assert run.policy.owner == MIDDLE
    assert run.policy.deadline() == HIGH_TIMEOUT + MIDDLE_TIMEOUT


def test_release_after_stands_in_for_the_timeout():
    lowest = Flow(name="lowest", publisher="/lowest", priority=0)
    chosen = settings(PolicyName.PRIORITY_QUEUE)
    run = Run(settings(PolicyName.PRIORITY_QUEUE, flows=(*chosen.flows, lowest)))
    run.play([(5, LOW), (RELEASE_AFTER - 1, "lowest")])
    assert run.verdicts[1].decision is HOLD
    assert run.policy.deadline() == 5 + RELEASE_AFTER


def test_the_freshest_goes():
    run = commands().play([(0, HIGH), (1, LOW), (1, LOW), (1, LOW), (HIGH_TIMEOUT, TICK)])
    assert [(m.number, v.decision) for _, m, v in run.left[1:]] == [(1, DROP), (2, DROP), (3, PASS)]


def test_a_higher_command_never_waits_for_a_lower_one_that_is_due():
    run = commands().play([(0, MIDDLE), (1, LOW), (MIDDLE_TIMEOUT, HIGH)])
    assert run.verdicts[2].decision is PASS
    assert run.tick() == []


def test_a_lower_command_does_not_overtake_a_higher_one_that_is_due():
    run = commands().play([(0, HIGH), (1, MIDDLE), (HIGH_TIMEOUT, LOW)])
    assert run.verdicts[2].decision is HOLD
    assert run.verdicts[2].reason == "middle goes next (priority 2)"
    assert run.tick() == [(1, PASS)]


def test_a_flow_whose_command_is_too_old_still_masks_until_it_is_silent():
    run = commands(max_age=1).play([(0, HIGH), (14, MIDDLE), (2, TICK), (0, LOW)])
    assert run.verdicts[2].decision is HOLD
    assert run.verdicts[2].reason == "middle goes next (priority 2)"
    assert run.policy.owner is None
    assert run.tick() == []


def test_a_flow_whose_command_found_no_room_still_masks_until_it_is_silent():
    run = commands(queue_size=1).play([(0, HIGH), (14, LOW), (0, MIDDLE), (2, TICK)])
    assert run.verdicts[2].decision is DROP
    assert run.policy.owner is None
    assert run.policy.deadline() == 14 + MIDDLE_TIMEOUT
    run.wait(MIDDLE_TIMEOUT - 2)
    assert run.tick() == [(1, PASS)]


def test_a_command_that_was_due_is_not_settled_against_higher_ones():
    run = commands().play([(0, HIGH), (1, LOW), (HIGH_TIMEOUT, HIGH), (1, MIDDLE)])
    run.wait(HIGH_TIMEOUT - 1)
    assert run.tick() == [(3, PASS)]


def test_a_passing_command_replaces_the_one_of_its_flow_that_waits():
    run = commands().play([(0, HIGH), (1, LOW), (HIGH_TIMEOUT, LOW)])
    assert run.verdicts[2].decision is PASS
    assert run.tick() == [(1, DROP)]


def test_a_blocked_flow_masks_nobody():
    run = commands().play([(0, BLOCKED), (0, LOW)])
    assert run.verdicts[1].decision is PASS


def test_done_takes_the_owner_for_silent():
    run = commands().play([(0, HIGH), (1, LOW), (1, DONE)])
    assert run.policy.owner is None
    assert run.policy.deadline() == run.now
    assert run.tick() == [(1, PASS)]


def test_done_without_an_owner_changes_nothing():
    assert commands().play([(0, DONE), (0, LOW)]).verdicts[0].decision is PASS


def test_nothing_interrupts_an_action_and_the_next_is_the_highest_then_the_earliest():
    run = actions().play([(0, LOW), (1, LOW), (1, MIDDLE), (1, HIGH), (1, HIGH)])
    assert [v.decision for v in run.verdicts] == [PASS, HOLD, HOLD, HOLD, HOLD]
    for number in (3, 4, 2, 1):
        run.do(DONE)
        assert run.tick() == [(number, PASS)]


def test_what_is_next_is_settled_when_the_turn_ends():
    run = actions().play([(0, MIDDLE), (1, LOW), (1, LOW), (MIDDLE_TIMEOUT, HIGH)])
    assert run.tick() == [(1, PASS)]
    run.do(DONE)
    assert run.tick() == [(3, PASS)]


def test_when_the_settled_one_grows_too_old_another_is_settled():
    run = actions(max_age=MAX_AGE).play([(0, LOW), (0, LOW), (1, MIDDLE), (1, DONE)])
    run.play([(MAX_AGE - 2, HIGH)])
    assert run.tick() == [(1, DROP), (2, PASS)]


@pytest.mark.parametrize(("late", "left"), [(-1, []), (0, [(1, PASS)]), (1, [(1, PASS)])])
@pytest.mark.parametrize(("flow", "limit"), [(MIDDLE, MIDDLE_TIMEOUT), (LOW, MAX_HOLD)])
def test_the_next_goes_when_the_action_in_progress_is_overdue(flow, limit, late, left):
    run = actions().play([(5, flow), (0, HIGH)])
    run.wait(limit + late)
    assert run.tick() == left
