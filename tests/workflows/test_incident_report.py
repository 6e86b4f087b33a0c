"""What a report has of an incident, and that none is longer than its bound."""

import json

import pytest
from guarded_drive import ALLOWED, FAST, posed_plan, speed_plan
from incident_reports import longest_report
from saved_incident import START, WALL, saved_incident

from rtron.guard.incidents.entries import LeaseAnswered
from rtron.reports.incident import comparison_sentence
from rtron.sources.bag.incident import IncidentFile
from rtron.vocabulary import SECOND, NodeSettings, Settings, Velocity
from rtron.wire.common.incident_report import (
    MAX_NUMBER,
    MAX_POINTS,
    MAX_REPORT_BYTES,
    MAX_TEXT,
    encode_report,
)
from rtron.workflows.incident_report import incident_report
from rtron.workflows.what_if import SpeedCurve

SPEEDS = [0.1] * 20 + [FAST] * 20 + [None] * 60


@pytest.fixture
def folder(tmp_path):
    path = tmp_path / "incidents"
    path.mkdir()
    return path


def report_of(path):
    return incident_report(IncidentFile(path), comparison_sentence)


def test_command_and_output_are_in_the_same_steps(folder):
    path = saved_incident(folder, SPEEDS)
    report = report_of(path)
    (topic,) = report.topics
    (flow,) = topic.flows
    assert (report.name, report.size) == (path.name, path.stat().st_size)
    assert report.at == WALL + START + SECOND
    assert (flow.flow, flow.publisher) == ("flow1", "/teleop")
    assert flow.verdicts == {"pass": 20, "hold": 0, "drop": 0, "modify": 20}
    at_cause = int(-report.begin / report.step)
    assert flow.speeds[at_cause - 1] == 0.1
    assert flow.speeds[at_cause + 1] == FAST
    assert topic.output[at_cause + 1] == pytest.approx(ALLOWED, abs=0.001)
    assert max(each or 0 for each in topic.output) <= ALLOWED
    assert topic.limits[at_cause + 1] == ALLOWED
    assert flow.speeds[-1] is None
    assert {len(flow.speeds), len(topic.output), len(topic.limits)} == {MAX_POINTS}


def test_the_report_names_cause_and_commander(folder):
    report = report_of(saved_incident(folder, SPEEDS))
    assert (report.gravest.kind, report.gravest.topic) == ("stop", "/cmd_vel")
    assert report.causes[0].at == 0
    assert (report.owner, report.publisher) == ("flow1", "/teleop")
    assert [each.decision for each in report.topics[0].changes] == ["pass", "modify"]


def test_who_begins_with_the_cause_was_in_command(folder):
    report = report_of(saved_incident(folder, [None] * 10 + [FAST] * 20))
    assert report.causes[0].at == 0.0
    assert (report.owner, report.publisher) == ("flow1", "/teleop")


def test_who_asked_for_a_lease_is_in_the_timeline(folder):
    asked = LeaseAnswered(START, "base", "take_over by /agent", False, "it has no higher rank")  # noqa: FBT003
    (event,) = report_of(saved_incident(folder, SPEEDS, noted=[asked])).events
    assert (event.kind, event.at) == ("lease", -1.0)
    assert event.reason == "base: take_over by /agent is refused: it has no higher rank"


def test_a_peak_between_two_steps_is_not_lost(folder):
    path = saved_incident(folder, [0.1] * 900 + [FAST] + [0.1] * 100)
    (flow,) = report_of(path).topics[0].flows
    assert max(each or 0 for each in flow.speeds) == FAST


def test_without_the_guard_is_a_sentence_a_curve_and_a_path_into_an_area(folder):
    plan = posed_plan(keep=60 * SECOND, after=60 * SECOND)
    report = report_of(saved_incident(folder, [0.1] * 20 + [FAST] * 80, plan))
    (without,) = report.alternatives
    assert "1.00 m/s instead of 0.25 m/s" in without.sentences[0]
    assert "into kitchen" in without.sentences[0]
    assert max(each or 0 for each in without.outputs["/cmd_vel"]) == FAST
    assert (report.frame, report.areas[0].name) == ("map", "kitchen")
    assert without.path[-1][0] > 3.0 > report.path[-1][0]


def test_the_settings_before_are_played_if_they_are_known(folder):
    slower = Settings(revision=1, nodes={"rsrcn": NodeSettings(max_vel_limit=0.2)})
    plan = speed_plan(keep=60 * SECOND, after=60 * SECOND)
    path = saved_incident(folder, SPEEDS, plan, changed=slower)
    titles = [each.title for each in report_of(path).alternatives]
    assert titles == ["without the guard", "under the settings before, revision 0"]


def test_no_speed_of_a_stranger_breaks_a_report(folder):
    speeds = [0.1] * 5 + [1e308, float("nan"), float("inf"), -1e308] * 10 + [None] * 40
    report = report_of(saved_incident(folder, speeds))
    document = json.loads(encode_report(report))
    assert max(each or 0 for each in report.topics[0].flows[0].speeds) == MAX_NUMBER
    assert document["alternatives"][0]["sentences"]


def test_a_robot_that_spins_without_bound_has_a_path():
    curve = [(n * SECOND, Velocity((0.1,), (1e308,))) for n in range(100)]
    assert len(SpeedCurve(curve).path()) > 100


def test_names_are_cut_and_steer_nothing(folder):
    plan = speed_plan(app="a\u202eb" + "x" * 500, keep=60 * SECOND, after=60 * SECOND)
    report = report_of(saved_incident(folder, SPEEDS, plan))
    assert "\u202e" not in report.app
    assert len(report.app) == MAX_TEXT


def test_the_longest_report_is_within_the_bound():
    assert len(encode_report(longest_report())) <= MAX_REPORT_BYTES
