"""What the soak finds wrong in speeds, blocks, goals and figures."""

import json

import pytest

from bench.soak.base_log import Command, Span
from bench.soak.faults import FREEZE, INTRUSION, KILL, WEIGHTS, Fault, RandomFaults
from bench.soak.goal_log import count_ends, count_forbidden, read_goals, unexplained
from bench.soak.names import FORBIDDEN_GOAL
from bench.soak.plan import LOWEST, MAX_SPEED, THRESHOLD, soak_plan
from bench.soak.policy_checks import Block, SpeedCheck, blocks, longest_drive, rows
from bench.soak.report import Row, write_json
from rtron.planning.plan_file.loader import parse_plan
from rtron.vocabulary import SECOND, CoordinationKind, build_streams


@pytest.mark.parametrize("ros", [1, 2])
def test_the_plan_has_every_kind_of_coordination_node(ros):
    plan = parse_plan(soak_plan(ros))
    stages = [stage for stream in build_streams(plan) for stage in stream.stages]
    kinds = {stage.coordination_kind for stage in stages}
    assert kinds == set(CoordinationKind) - {CoordinationKind.FPS_MONITOR}
    assert plan.fps_monitor
    assert any(stream.action for stream in build_streams(plan))


def frames(rate, begin, end):
    return range(begin, end, SECOND // rate)


SLOW = SpeedCheck(frames(4, 0, 10 * SECOND))


def test_the_frame_rate_limits_the_speed():
    assert SLOW.allowed(5 * SECOND) == pytest.approx(5 * THRESHOLD)
    assert SpeedCheck(frames(20, 0, 10 * SECOND)).allowed(5 * SECOND) == MAX_SPEED


def test_without_pictures_the_lowest_speed_is_left():
    assert SpeedCheck([]).allowed(SECOND) == LOWEST
    assert SLOW.allowed(12 * SECOND) == LOWEST


def test_a_command_is_too_fast_when_the_rate_has_fallen_a_moment_ago():
    fast = 5 * THRESHOLD
    late = [Command(at * SECOND // 10, fast) for at in (60, 104, 112, 130)]
    assert SLOW.over_limit(late) == late[2:]


def test_a_block_lasts_from_the_first_word_to_the_last():
    words = [[1, 0], [2, 1], [3, 1], [4, 0], [5, 1], [6, 1]]
    assert list(blocks(words)) == [Block(2, 4), Block(5, 6)]


def test_a_base_drives_on_until_its_last_command_in_the_block():
    commands = [Command(1, 0.3), Command(3, 0.2), Command(4, 0.1), Command(5, 0.0), Command(9, 0.3)]
    assert longest_drive(Block(2, 8), commands) == 2
    assert longest_drive(Block(2, 10), commands) == 7
    assert longest_drive(Block(6, 8), commands) == 0


@pytest.fixture
def goals(tmp_path):
    path = tmp_path / "planner.txt"
    path.write_text(
        "0 1 sent\n0 1 accepted\n1 1 succeeded\n"
        "0 2 sent\n0 2 accepted\n1 2 cancel\n1 2 canceled\n"
        "0 3 sent\n0 3 accepted\n1 3 canceled\n"
        "0 4 sent\n0 4 accepted\n1 4 lost\n"
        f"{20 * SECOND} 5 sent\n0 5 lost\n"
        "0 6 sent\n0 6 acc"
    )
    return read_goals(path)


def test_what_became_of_goals_is_counted(goals):
    assert count_ends(goals) == {"succeeded": 1, "canceled": 2, "lost": 2}


def test_a_goal_that_others_end_is_found(goals):
    assert [each.is_canceled_by_others for each in goals].index(True) == 2
    assert sum(each.is_canceled_by_others for each in goals) == 1


def test_a_goal_that_was_accepted_and_forgotten_is_found(goals):
    assert [each.is_lost for each in goals] == [False, False, False, True, False, False]


def test_a_goal_without_an_answer_is_explained_by_a_fault_beside_it(goals):
    assert unexplained(goals, [SECOND]) == [goals[4]]
    assert unexplained(goals, [19 * SECOND]) == []


def test_goals_of_strangers_are_counted(tmp_path):
    path = tmp_path / "dock.txt"
    path.write_text(f"1 50\n2 {FORBIDDEN_GOAL}\n3 {FORBIDDEN_GOAL}")
    assert count_forbidden(rows(path)) == 1


OVER = Row("a", "a figure", 2.0, "ms", at_most=1.0)


@pytest.mark.parametrize(
    ("row", "verdict"),
    [
        (OVER, "OVER"),
        (Row("a", "a figure", 1.0, "ms", at_most=1.0), "ok"),
        (Row("a", "a figure", 0.0, "", at_least=1.0), "OVER"),
        (Row("a", "a figure", None, "", at_most=1.0), "not measured"),
        (Row("a", "a figure", 7.0, ""), ""),
    ],
)
def test_a_figure_is_compared_with_its_bound(row, verdict):
    assert row.verdict == verdict
    assert row.is_over == (verdict == "OVER")


def test_programs_get_figures_bounds_and_what_was_over(tmp_path):
    path = tmp_path / "new" / "soak.json"
    write_json(path, [OVER, Row("b", "another", 7.0, "")], seed=3)
    written = json.loads(path.read_text())
    assert (written["seed"], written["over"]) == (3, ["a"])
    assert written["figures"]["a"]["at_most"] == 1.0
    assert written["figures"]["b"]["verdict"] == ""


def test_everything_that_can_happen_is_done_by_the_soak():
    faults = RandomFaults(app=None, seed=1)
    assert faults.counts() == dict.fromkeys(WEIGHTS, 0)
    assert set(faults._actions) == set(WEIGHTS)


def test_stops_are_explained_by_a_guard_that_was_frozen_or_killed_a_moment_ago():
    faults = RandomFaults(app=None, seed=1)
    spans = {FREEZE: Span(10 * SECOND, SECOND), KILL: Span(20 * SECOND, 1)}
    faults.history += [Fault(name, span) for name, span in spans.items()]
    faults.history.append(Fault("bulk process killed", Span(30 * SECOND, 1)))
    explained = [10 * SECOND, 12 * SECOND - 1, 21 * SECOND]
    assert faults.count_unexplained(explained) == 0
    assert faults.count_unexplained([*explained, 9 * SECOND, 13 * SECOND, 30 * SECOND]) == 3


def test_a_clear_lasts_from_an_intruders_end():
    faults = RandomFaults(app=None, seed=1)
    assert faults.longest_clear() is None
    faults.intruders += [Span(0, 2 * SECOND), Span(20 * SECOND, SECOND)]
    faults.history += [Fault(INTRUSION, Span(at * SECOND, 7 * SECOND)) for at in (0, 20)]
    assert faults.longest_clear() == 6 * SECOND
