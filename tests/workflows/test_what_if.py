"""What would have been in an incident: the recorded minute under other plans, and under none."""

from dataclasses import replace

import pytest
from guarded_drive import ALLOWED, FAST, posed_plan, speed_plan
from hypothesis import given
from hypothesis import strategies as st
from saved_incident import saved_incident

from rtron.errors import InputError
from rtron.reports.incident import comparison_sentence
from rtron.sources.bag.incident import IncidentFile
from rtron.vocabulary import (
    SECOND,
    Area,
    LeaseGroup,
    NodeSettings,
    NotedPose,
    Point,
    Settings,
    Velocity,
)
from rtron.workflows.incidents import read_account
from rtron.workflows.what_if import (
    SpeedCurve,
    as_it_was,
    as_planned,
    compare,
    plan_areas,
    under_former_settings,
    under_plan,
    without_guard,
)

CMD = "/cmd_vel"


@pytest.fixture
def opened(tmp_path):
    return IncidentFile(saved_incident(tmp_path, [0.1] * 20 + [FAST] * 40 + [None] * 60))


def speeds(curve):
    return [velocity.linear[0] for _, velocity in curve]


def test_without_the_guard_the_base_gets_what_was_published(opened):
    account = read_account(opened)
    found = without_guard(account)
    assert speeds(found.outputs[CMD]) == [0.1] * 20 + [FAST] * 40
    (comparison,) = compare(account, found)
    assert (comparison.alternative, comparison.actual) == (FAST, ALLOWED)
    assert comparison.differs_from == 0


def test_as_it_was_is_what_went_out(opened):
    account = read_account(opened)
    assert as_it_was(opened).outputs[CMD] == account.topics[CMD].output
    (comparison,) = compare(account, as_it_was(opened))
    assert comparison.differs_from is None


def test_a_plan_with_leases_is_refused_since_requests_are_not_played(opened):
    plan = replace(opened.plan[0], leases=(LeaseGroup(name="base"),))
    with pytest.raises(InputError, match="requests are not played"):
        under_plan(opened, plan, "with leases")


commands = st.lists(st.sampled_from([None, 0.0, 0.1, 0.2, FAST, 3.0]), min_size=1, max_size=60)


@given(commands)
def test_whatever_was_driven_the_same_plan_does_the_same_again(tmp_path_factory, driven):
    path = saved_incident(tmp_path_factory.mktemp("incident"), [0.1, FAST, *driven])
    opened = IncidentFile(path)
    assert as_it_was(opened).outputs[CMD] == read_account(opened).topics[CMD].output


def test_another_plan_lets_other_speeds_pass(opened):
    found = under_plan(opened, speed_plan(limit=0.5), "under another plan")
    assert max(speeds(found.outputs[CMD])) == 0.5
    stricter = under_plan(opened, speed_plan(limit=0.05), "under a stricter plan")
    assert max(speeds(stricter.outputs[CMD])) == 0.05


def test_a_plan_that_does_not_know_the_publisher_stops_and_says_so(opened):
    plan = speed_plan()
    (node,) = plan.grcn
    flows = (replace(node.flows[0], publisher="/somebody_else"),)
    topic = replace(plan.rsrcn.vflows[0], flows=flows)
    rsrcn = replace(plan.rsrcn, vflows=(topic,))
    other = replace(plan, grcn=(replace(node, flows=flows),), rsrcn=rsrcn)
    found = under_plan(opened, other, "without /teleop")
    assert found.outputs[CMD] == []
    assert "/teleop is not approved" in found.notes[0]


def test_settings_that_were_in_force_count_as_it_was_and_not_as_planned(tmp_path):
    lower = Settings(revision=1, nodes={"rsrcn": NodeSettings(max_vel_limit=0.05)})
    path = saved_incident(tmp_path, [FAST] * 40, settings=lower)
    opened = IncidentFile(path)
    assert max(speeds(as_it_was(opened).outputs[CMD])) == 0.05
    assert max(speeds(as_planned(opened).outputs[CMD])) == ALLOWED


def test_the_settings_before_the_last_change_are_in_the_incident(tmp_path, opened):
    lower = Settings(revision=1, nodes={"rsrcn": NodeSettings(max_vel_limit=0.05)})
    higher = Settings(revision=2, nodes={"rsrcn": NodeSettings(max_vel_limit=0.5)})
    folder = tmp_path / "changed"
    folder.mkdir()
    path = saved_incident(folder, [FAST] * 40, settings=lower, changed=higher)
    found = under_former_settings(IncidentFile(path))
    assert max(speeds(found.outputs[CMD])) == 0.05
    assert found.title.endswith("revision 1")
    assert max(speeds(as_it_was(IncidentFile(path)).outputs[CMD])) == 0.5
    with pytest.raises(InputError, match="not changed"):
        under_former_settings(opened)


def test_a_plan_of_the_other_ros_is_refused(opened):
    with pytest.raises(InputError, match="is for ROS 2"):
        under_plan(opened, replace(speed_plan(), ros=2), "")


def curve(*pairs):
    return [(int(at * SECOND), Velocity((x, 0.0, 0.0), (0.0, 0.0, turn))) for at, x, turn in pairs]


def test_a_command_holds_until_the_next_and_a_second_at_most():
    driven = SpeedCurve(curve((0, 1.0, 0.0), (0.5, 2.0, 0.0), (5, 0.0, 0.0)))
    times = (-1, 0, 0.4, 0.5, 1.5, 1.6)
    assert [driven.speed(int(at * SECOND)) for at in times] == [0, 1, 1, 2, 2, 0]
    assert driven.way() == pytest.approx(0.5 + 2.0)


def test_a_quarter_circle_ends_where_it_should():
    quarter = [(n / 100, 1.5707963267948966, 1.5707963267948966) for n in range(100)]
    _, x, y = SpeedCurve(curve(*quarter, (1.0, 0.0, 0.0))).path()[-1]
    assert (x, y) == (pytest.approx(1.0, abs=1e-3), pytest.approx(1.0, abs=1e-3))


KITCHEN = Area(
    name="kitchen",
    frame="map",
    polygon=(
        Point(x=12.0, y=-1.0),
        Point(x=14.0, y=-1.0),
        Point(x=14.0, y=1.0),
        Point(x=12.0, y=1.0),
    ),
)


def posed(account, *poses):
    found = [NotedPose(int(at * SECOND), "map", x, 0.0, 0.0) for at, x in poses]
    return replace(account, poses={"/pose": found})


def test_the_robot_would_have_come_into_the_area_ahead_of_it(opened):
    account = posed(read_account(opened), (-1.0, 10.0), (0.0, 10.5), (2.0, 11.0))
    (found,) = compare(account, without_guard(account), [KITCHEN])
    ((name, when),) = found.areas
    assert name == "kitchen"
    assert when / SECOND == pytest.approx(1.5, abs=0.06)


def test_an_area_that_the_robot_was_in_anyway_is_no_news(opened):
    account = posed(read_account(opened), (-1.0, 10.0), (0.0, 10.5), (3.0, 13.0))
    (found,) = compare(account, without_guard(account), [KITCHEN])
    assert found.areas == ()


def test_areas_in_another_frame_and_incidents_without_poses_say_nothing(opened):
    account = read_account(opened)
    (found,) = compare(account, without_guard(account), [KITCHEN])
    assert found.areas == ()
    elsewhere = replace(KITCHEN, frame="odom")
    account = posed(account, (0.0, 10.5))
    (found,) = compare(account, without_guard(account), [elsewhere])
    assert found.areas == ()


def test_poses_that_rules_read_are_in_the_incident_and_say_where_it_would_have_been(tmp_path):
    plan = posed_plan(after=60 * SECOND)
    path = saved_incident(tmp_path, [0.2] * 100 + [FAST] * 80 + [None] * 40, plan)
    opened = IncidentFile(path)
    account = read_account(opened)
    found = [pose for pose in account.poses["/pose"] if pose.at >= 0]
    assert (found[0].frame, found[0].x) == ("map", pytest.approx(1.0))
    (comparison,) = compare(account, without_guard(account), plan_areas(opened))
    ((name, when),) = comparison.areas
    assert (name, when / SECOND) == ("kitchen", pytest.approx(2.0, abs=0.06))
    assert "into kitchen after 2.0 s" in comparison_sentence(comparison)
    assert as_it_was(opened).outputs[CMD] == account.topics[CMD].output


def test_nothing_driven_is_no_way():
    assert SpeedCurve([]).path() == []
    assert SpeedCurve([]).way() == 0


def test_a_rule_that_stopped_the_robot_stops_it_again(tmp_path):
    path = saved_incident(tmp_path, [0.2] * 40 + [FAST] * 260, posed_plan(after=60 * SECOND))
    opened = IncidentFile(path)
    account = read_account(opened)
    assert account.topics[CMD].verdicts["flow1", "drop"] > 10
    assert "rule keep_out" in account.topics[CMD].changes[-1].reason
    assert [event.kind for event in account.events if event.kind == "rule"]
    assert as_it_was(opened).outputs[CMD] == account.topics[CMD].output
