"""Which robots are next, when a limit is passed, and what goes back: at the bounds of each."""

from dataclasses import replace

import pytest

from rtron.service.domain.rollouts.amounts import ALL, Amount, parse_amount
from rtron.service.domain.rollouts.decisions import (
    RobotProgress,
    RolloutProgress,
    next_steps,
    stage_targets,
)
from rtron.service.domain.rollouts.schemas import Problem, RobotPhase, RolloutState

WAITING, SENDING, SENT = RobotPhase.WAITING, RobotPhase.SENDING, RobotPhase.SENT
RUNNING, PAUSED, REVERTING = RolloutState.RUNNING, RolloutState.PAUSED, RolloutState.REVERTING
DONE, REVERTED, CANCELLED = RolloutState.DONE, RolloutState.REVERTED, RolloutState.CANCELLED
LIMITS = {problem: Amount(0) for problem in Problem}


def share(text):
    return parse_amount(text)


def rollout(**values):
    given = {"state": RUNNING, "stage": 0, "changed": 0, "targets": (1, 10, 100)}
    return RolloutProgress(**{**given, "wait": 300, "limits": LIMITS, **values})


def fleet(size=100, sent=0, **values):
    """`sent` robots have the change and have answered, the others wait."""
    has = {"phase": SENT, "is_answered": True, "sent_at": 1000, **values}
    return [
        RobotProgress(robot=f"r{index}", **(has if index < sent else {})) for index in range(size)
    ]


def decide(robots, *, now=1000, batch=20, **values):
    return next_steps(rollout(**values), robots, now, batch)


def changed(robots, index, **values):
    return [replace(each, **values) if i == index else each for i, each in enumerate(robots)]


@pytest.mark.parametrize(
    ("value", "text", "of_one", "of_99", "of_1000"),
    [
        (0, "0", 0, 0, 0),
        (7, "7", 7, 7, 7),
        ("10%", "10%", 1, 10, 100),
        ("0.5 %", "0.5%", 1, 1, 5),
        ("0.05%", "0.05%", 1, 1, 1),
        ("100%", "100%", 1, 99, 1000),
        ("33.33%", "33.33%", 1, 33, 334),
    ],
)
def test_amounts_are_numbers_or_shares_rounded_up(value, text, of_one, of_99, of_1000):
    amount = parse_amount(value)
    assert str(amount) == text
    assert [amount.at_least(total) for total in (1, 99, 1000)] == [of_one, of_99, of_1000]


@pytest.mark.parametrize(
    ("value", "total", "allowed"),
    [("2%", 49, 0), ("2%", 50, 1), ("2%", 99, 1), ("2%", 100, 2), (3, 1, 3), ("100%", 7, 7)],
)
def test_limits_are_rounded_down(value, total, allowed):
    assert parse_amount(value).at_most(total) == allowed


@pytest.mark.parametrize(
    "value",
    [-1, 1.5, True, None, "", "%", "10", "-1%", "100.01%", "1e1%", "1000%", "\u0661%", [], 10**9],
)
def test_what_is_no_amount(value):
    with pytest.raises(ValueError, match=r"robots|100%"):
        parse_amount(value)


@pytest.mark.parametrize(
    ("total", "targets"),
    [(1, (1,)), (2, (1, 2)), (10, (1, 10)), (11, (1, 2, 11)), (1000, (1, 100, 1000))],
)
def test_stages_of_small_fleets_fall_together(total, targets):
    assert stage_targets((Amount(1), share("10%"), ALL), total) == targets


def test_a_stage_of_more_robots_than_there_are():
    assert stage_targets((Amount(5), ALL), 3) == (3,)


def test_first_one_canary():
    assert decide(fleet()).send == ["r0"]


def test_the_canary_is_the_first_that_is_ready():
    robots = changed(changed(fleet(), 0, is_ready=False), 1, is_ready=False)
    assert decide(robots).send == ["r2"]
    assert decide([replace(each, is_ready=False) for each in fleet()]).send == ()


@pytest.mark.parametrize(("later", "stage"), [(299, 0), (300, 1), (301, 1)])
def test_the_next_stage_comes_after_the_wait(later, stage):
    steps = decide(fleet(sent=1), now=1000 + later)
    assert (steps.state, steps.stage, steps.send) == (RUNNING, stage, ())


def test_the_wait_counts_from_the_last_robot_of_the_stage():
    robots = changed(fleet(sent=10), 4, sent_at=1200)
    assert decide(robots, stage=1, now=1499).stage == 1
    assert decide(robots, stage=1, now=1500).stage == 2


@pytest.mark.parametrize(("now", "count"), [(1009, 6), (1010, 20)])
def test_a_stage_goes_out_no_faster_than_it_shows(now, count):
    """Of the 15 that have the change 14 got it at 1000."""
    robots = changed(fleet(sent=15), 0, sent_at=500)
    assert len(decide(robots, now=now, stage=2, pace=10).send) == count


@pytest.mark.parametrize(
    ("sent", "batch", "count"), [(1, 20, 9), (9, 20, 1), (1, 4, 4), (10, 20, 0)]
)
def test_a_stage_is_filled_and_no_robot_more(sent, batch, count):
    steps = decide(fleet(sent=sent), stage=1, batch=batch)
    assert list(steps.send) == [f"r{index}" for index in range(sent, sent + count)]


def test_who_has_not_answered_is_waited_for():
    robots = changed(fleet(sent=1), 0, is_answered=False)
    assert decide(robots, now=10**9).stage == 0


@pytest.mark.parametrize(
    ("problem", "stage"),
    [(Problem.ALARM, 0), (Problem.STOPPED, 0), (Problem.GONE, 1), (Problem.REFUSED, 1)],
)
def test_only_an_end_of_waiting_stands_for_an_answer(problem, stage):
    robots = changed(fleet(sent=1), 0, is_answered=False, problems=frozenset({problem}))
    limits = dict.fromkeys(Problem, share("100%"))
    assert decide(robots, now=10**12, limits=limits).stage == stage


def test_a_send_that_was_cut_off_is_made_again_and_fills_the_stage():
    robots = changed(fleet(), 3, phase=SENDING)
    assert decide(robots).send == ["r3"]


def test_an_early_stage_waits_for_robots_that_are_off():
    robots = [replace(each, is_ready=each.has_change) for each in fleet(sent=5)]
    assert decide(robots, stage=1, now=10**9).stage == 1


def test_the_last_stage_is_done_without_robots_that_are_off():
    robots = changed(fleet(sent=98), 98, is_ready=False)
    assert decide(robots, stage=2, now=10**9).send == ["r99"]
    robots = changed(robots, 99, is_ready=False)
    steps = decide(robots, stage=2, now=1300)
    assert (steps.state, steps.note) == (DONE, "2 robots were off")
    assert decide(robots, stage=2, now=1299).state == RUNNING


def test_the_last_stage_is_done_when_all_have_it():
    steps = decide(fleet(sent=100), stage=2, now=1300)
    assert (steps.state, steps.send, steps.note) == (DONE, (), "")


@pytest.mark.parametrize("problem", list(Problem))
def test_each_problem_of_the_canary_turns_it_back(problem):
    robots = changed(fleet(sent=1), 0, problems=frozenset({problem}))
    steps = decide(robots)
    assert (steps.state, steps.revert, steps.send) == (REVERTING, ["r0"], ())
    assert steps.note == f"{problem}: 1 of 1 robots, at most 0: r0"


@pytest.mark.parametrize(
    ("limit", "sent", "bad", "passed"),
    [
        (Amount(0), 10, 0, False),
        (Amount(0), 10, 1, True),
        (Amount(2), 10, 2, False),
        (Amount(2), 10, 3, True),
        ("10%", 9, 1, True),
        ("10%", 10, 1, False),
        ("10%", 19, 2, True),
        ("10%", 20, 2, False),
        ("100%", 10, 10, False),
    ],
)
def test_limits_at_their_bounds(limit, sent, bad, passed):
    limits = {**LIMITS, Problem.ALARM: parse_amount(limit) if isinstance(limit, str) else limit}
    robots = fleet(sent=sent)
    for index in range(bad):
        robots = changed(robots, index, problems=frozenset({Problem.ALARM}))
    steps = decide(robots, stage=2, limits=limits, now=1001)
    assert (steps.state is REVERTING) is passed


def test_a_limit_counts_one_problem_not_all():
    limits = dict.fromkeys(Problem, Amount(1))
    robots = changed(fleet(sent=2), 0, problems=frozenset({Problem.ALARM}))
    robots = changed(robots, 1, problems=frozenset({Problem.STOPPED}))
    assert decide(robots, stage=1, limits=limits).state is RUNNING


def test_what_robots_show_that_do_not_have_the_change_counts_for_nothing():
    robots = changed(fleet(sent=1), 50, problems=frozenset({Problem.ALARM}))
    assert decide(robots).state is RUNNING


def test_a_note_names_five_robots():
    robots = fleet(sent=8, problems=frozenset({Problem.GONE}))
    assert decide(robots, stage=1).note.endswith("r0, r1, r2, r3, r4 and 3 more")


def test_all_that_have_the_change_lose_it_a_batch_at_a_time():
    robots = changed(fleet(sent=30), 30, phase=SENDING)
    steps = decide(robots, state=REVERTING)
    assert (steps.state, len(steps.revert)) == (REVERTING, 20)
    robots = [
        replace(each, phase=RobotPhase.REVERTED) if i < 30 else each
        for i, each in enumerate(robots)
    ]
    assert decide(robots, state=REVERTING).revert == ["r30"]
    robots = changed(robots, 30, phase=RobotPhase.STUCK)
    assert decide(robots, state=REVERTING).state is REVERTED


def test_a_paused_one_sends_nothing_but_goes_back():
    assert decide(fleet(), state=PAUSED).send == ()
    assert decide(fleet(sent=1), state=PAUSED, now=10**9).stage == 0
    bad = changed(fleet(sent=1), 0, problems=frozenset({Problem.ALARM}))
    assert decide(bad, state=PAUSED).state is REVERTING


@pytest.mark.parametrize("state", [REVERTED, CANCELLED])
def test_after_the_end_nothing_happens(state):
    bad = fleet(sent=50, problems=frozenset({Problem.ALARM}))
    steps = decide(bad, state=state, now=10**9)
    assert (steps.state, steps.send, steps.revert) == (state, (), ())


def test_robots_that_were_off_catch_up():
    robots = [replace(each, is_ready=each.robot != "r99") for each in fleet(sent=97)]
    steps = decide(robots, state=DONE, stage=2, changed=2000)
    assert (steps.state, steps.send, steps.revert) == (DONE, ["r97", "r98"], [])


@pytest.mark.parametrize(("sent_at", "reverted"), [(1999, []), (2000, []), (2001, ["r5"])])
def test_of_those_that_catch_up_each_loses_the_change_by_itself(sent_at, reverted):
    robots = changed(fleet(sent=100), 5, sent_at=sent_at, problems=frozenset({Problem.STOPPED}))
    steps = decide(robots, state=DONE, stage=2, changed=2000)
    assert (steps.state, steps.revert, steps.send) == (DONE, reverted, [])
