"""What is measured of a run: the way, the journal, the verdicts, the table."""

import json
from math import pi

import pytest
from demo_runs import (
    BEGAN,
    CIRCLE,
    guard_event,
    guard_events,
    make_run,
    runs_by_variant,
)

from rtron.demos.metrics.case_run import Variant, decision_counts, first_stop
from rtron.demos.metrics.message_journal import Attack, measure_deviation, read_attack
from rtron.demos.metrics.table import cells, columns

LINE = ((0.0, 0.0), (4.0, 0.0))
ATTACKER = ("/cmd_vel", "/tb3_safe_control")


def test_a_way_does_not_deviate_from_itself():
    found = measure_deviation(CIRCLE, CIRCLE)
    assert (found.largest, found.mean) == pytest.approx((0, 0), abs=1e-12)


def test_a_parallel_way_is_its_distance_away():
    found = measure_deviation([(0.1 * n, 0.3) for n in range(40)], LINE)
    assert (found.largest, found.mean) == pytest.approx((0.3, 0.3))


def test_behind_its_end_a_way_is_as_far_as_the_end():
    assert measure_deviation([(7.0, 4.0)], LINE).largest == pytest.approx(5)


def test_a_way_around_a_point_is_a_radius_away():
    assert measure_deviation(CIRCLE, [(0.0, 0.0)]).mean == pytest.approx(1)
    assert measure_deviation([(0.0, 0.0)], CIRCLE).largest == pytest.approx(1, abs=2e-4)


def test_a_rest_does_not_weigh():
    half = [(0.02 * n, 0.0) for n in range(50)]
    off = [(1.0 + 0.02 * n, 1.0) for n in range(50)]
    rests = [*half, *off, *([off[-1]] * 10_000)]
    assert measure_deviation(rests, LINE).mean == pytest.approx(
        measure_deviation([*half, *off], LINE).mean
    )


def test_of_no_way_nothing_is_known():
    assert measure_deviation([], LINE) is None
    assert measure_deviation(LINE, []) is None


def write(folder, node, *entries):
    text = "".join(json.dumps(entry) + "\n" for entry in entries)
    (folder / f"{node}.jsonl").write_text(text)


def sent(wall):
    return {"wall": wall, "what": "sent", "topic": "/cmd_vel", "value": [0, -0.2]}


def received(wall, *value):
    return {"wall": wall, "what": "received", "topic": "/cmd_vel", "value": list(value)}


def is_turn(topic, value):
    return topic == "/cmd_vel" and value == (0.0, -0.2)


def test_the_journal_tells_what_was_sent_and_what_arrived(tmp_path):
    write(tmp_path, "safe", sent(3.0), sent(3.1), sent(1.0))
    write(tmp_path, "core", received(2.9, 0.2, 0), received(3.2, 0, -0.2), received(1.2, 0, -0.2))
    found = read_attack(tmp_path, (2.0, 9.0), is_turn)
    assert found == Attack(sent=(3.0, 3.1), delivered=(3.2,))
    assert read_attack(tmp_path, (2.0, 3.1), is_turn) == Attack(sent=(3.0, 3.1))


def test_a_line_that_is_still_being_written_is_left_for_later(tmp_path):
    write(tmp_path, "core", received(1.0, 0, -0.2))
    with (tmp_path / "core.jsonl").open("a") as file:
        file.write('{"wall": 2.0, "wh')
    assert read_attack(tmp_path, (0.0, 9.0), is_turn).delivered == (1.0,)


def test_the_guards_counts_are_told_flow_by_flow():
    found = decision_counts(guard_events())
    assert {each.flow for each in found} == {"flow1", "flow2", "unapproved"}
    third = [each for each in found if each.at == (BEGAN + 3) * 1_000_000_000]
    assert [each.counts["drop"] for each in third] == [0, 30, 0]
    assert [each.counts["pass"] for each in third] == [20, 0, 0]


def test_the_first_verdict_that_stops_an_attacker_counts():
    assert first_stop(guard_events(), *ATTACKER) == pytest.approx(BEGAN + 2.5004)
    assert first_stop(guard_events(), "/odom", ATTACKER[1]) is None
    assert first_stop(guard_events(), "/cmd_vel", "/move_base") is None


def test_whoever_is_not_in_the_plan_is_an_attacker():
    events = [guard_event(5.0, topic="/cmd_vel", flow="unapproved", decision="drop")]
    assert first_stop(events, *ATTACKER) == 5.0


def table_of(runs):
    return {title: tuple(values) for title, values in cells(columns(runs))}


def test_the_table_of_one_world():
    found = table_of(runs_by_variant().values())
    assert found["outcome"] == ("completed", "collision", "completed")
    assert found["collision"] == ("no", "yes", "no")
    assert found["malicious messages sent / delivered"] == ("-", "700 / 180", "700 / 0")
    assert found["stopped after, at most"] == ("-", "never", "0.4 ms")
    assert found["time to the goal (simulated)"] == ("19.1 s", "-", "19.1 s")
    assert found["off the way, at most / mean"][2] == "0.00 m / 0.00 m"


CAME = Attack(sent=(4.0,), delivered=(4.0,))


@pytest.mark.parametrize(
    ("fake_study", "mitigation", "cell"),
    [
        ([(0.002, CAME)], "stopped", "2.0 ms"),
        ([(None, Attack(sent=(4.0,)))], "nothing arrived", "nothing arrived"),
        ([(None, CAME)], "never", "never"),
        ([(None, Attack())], "", "-"),
        ([(0.002, CAME), (None, Attack(sent=(4.0,)))], "stopped", "2.0 ms, nothing arrived"),
        ([(0.002, CAME), (None, CAME), (None, Attack())], "stopped", "never"),
    ],
)
def test_where_nothing_arrived_no_time_is_made_up(fake_study, mitigation, cell):
    runs = [
        make_run(Variant.GUARDED, attack=attacked, mitigated_after=after)
        for after, attacked in fake_study
    ]
    assert runs[0].as_json()["mitigation"] == mitigation
    assert table_of(runs)["stopped after, at most"] == (cell,)


def test_the_table_of_two_worlds():
    worlds = [*runs_by_variant().values(), *runs_by_variant(seed=2).values()]
    worlds += [make_run(Variant.ATTACKED, seed=3, harm="", completed=True, collided=False)]
    found = table_of(worlds)
    assert found["outcome"][1] == "2 x collision, 1 x completed"
    assert found["collision"] == ("0 of 2", "2 of 3", "0 of 2")
    assert found["malicious messages sent / delivered"][2] == "1400 / 0"
    assert found["time to the goal (simulated)"][1] == "0 of 3 arrive"


def test_what_was_not_run_is_no_column():
    assert list(columns([make_run(Variant.ATTACKED)])) == [Variant.ATTACKED]


def test_a_runs_json_is_plain():
    run = make_run(Variant.ATTACKED)
    whole = json.loads(json.dumps(run.as_json(with_samples=True)))
    assert whole["samples"][0]["pose"] == [0.4, 0.6, 0.0]
    short = json.loads(json.dumps(run.as_json()))
    assert "samples" not in short
    assert short["outcome"] == "collision"
    assert short["deviation"]["largest"] == pytest.approx(run.deviation.largest)
    assert run.deviation.largest < pi
