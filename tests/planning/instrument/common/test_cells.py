"""What passes into and out of a cell, from graph and plan."""

import json
from dataclasses import replace

import pytest
from plans import grcn, plan_of

from rtron.errors import InputError
from rtron.guard.cell.runner import read_manifest
from rtron.planning.instrument.common.cells import plan_cells
from rtron.vocabulary import (
    Action,
    ActionRole,
    CarriedService,
    CarriedTopic,
    Direction,
    Endpoint,
    InteractionGraph,
    Node,
    Service,
    ServiceClient,
)

BASE = "/base"
TWIST = "geometry_msgs/Twist"
PLAN = plan_of(grcn("/cmd_vel", ["/nav"], [BASE]), cell=(BASE,))


def ends(direction, topic, type, *nodes):
    return [Endpoint(node=node, topic=topic, direction=direction, type=type) for node in nodes]


GRAPH = InteractionGraph(
    app="app",
    nodes=(Node(name=BASE), Node(name="/nav"), Node(name="/switch")),
    endpoints=(
        *ends(Direction.SUBSCRIBE, "/cmd_vel", TWIST, BASE),
        *ends(Direction.PUBLISH, "/cmd_vel", TWIST, "/nav"),
        *ends(Direction.SUBSCRIBE, "/lamp", "std_msgs/String", BASE),
        *ends(Direction.PUBLISH, "/lamp", "std_msgs/String", "/switch"),
        *ends(Direction.SUBSCRIBE, "/unheard", "std_msgs/String", BASE),
        *ends(Direction.SUBSCRIBE, "/raw_vel", TWIST, BASE),
        *ends(Direction.PUBLISH, "/raw_vel", TWIST, "/switch"),
        *ends(Direction.PUBLISH, "/odom", "nav_msgs/Odometry", BASE),
    ),
    services=(Service(node=BASE, name="/reset"), Service(node=BASE, name="/unused")),
    clients=(ServiceClient(node="/nav", name="/reset"), ServiceClient(node=BASE, name="/map")),
    actions=(Action(node=BASE, name="/dock", role=ActionRole.SERVER),),
)


@pytest.fixture
def cell():
    (cell,) = plan_cells(GRAPH, PLAN, ["--user", "a driver"])
    return cell


def test_what_the_base_publishes_passes_and_its_log(cell):
    assert {each.topic for each in cell.manifest.published} == {"/odom", "/rosout"}
    assert {each.publishers for each in cell.manifest.published} == {(BASE,)}


def test_what_it_hears_passes_from_its_publishers_but_no_unguarded_velocity(cell):
    lamp = CarriedTopic(topic="/lamp", type="std_msgs/String", publishers=("/switch",))
    assert cell.manifest.subscribed == (lamp,)
    notes = "\n".join(cell.notes)
    assert "/raw_vel does not pass into or out of the cell of /base: can move the robot" in notes
    assert "/unheard does not pass" in notes


def test_services_pass_for_those_who_call_them(cell):
    assert cell.manifest.served == (CarriedService(service="/reset", clients=("/nav",)),)
    assert cell.manifest.called == (CarriedService(service="/map", clients=(BASE,)),)
    assert any(note.startswith("/unused does not pass") for note in cell.notes)


def test_of_ros2_services_pass_with_their_types_and_parameters_do_not():
    reset = Service(node=BASE, name="/reset", type="std_srvs/srv/Trigger")
    graph = replace(GRAPH, ros=2, services=(reset, *GRAPH.services[1:]))
    (cell,) = plan_cells(graph, replace(PLAN, ros=2))
    carried = CarriedService(service="/reset", type=reset.type, clients=("/nav",))
    assert (cell.manifest.served, cell.manifest.called) == ((carried,), ())
    assert cell.manifest.parameters == ()
    assert any(note.startswith("/map does not pass") for note in cell.notes)
    assert any(note.startswith("/base has the parameters of its start") for note in cell.notes)
    assert not any("rtron master" in note for note in cell.notes)


def test_an_action_that_nobody_guards_and_the_publishers_own_end_are_noted(cell):
    assert any(note.startswith("/dock does not pass") for note in cell.notes)
    assert any(note.startswith("/nav is outside the cell of /base") for note in cell.notes)


def test_the_manifest_is_read_as_it_was_written(cell, tmp_path):
    texts = cell.texts()
    path = tmp_path / "cell_base.json"
    path.write_text(texts["cell_base.json"])
    assert read_manifest(path) == cell.manifest
    assert "--user 'a driver' -- \"$@\"" in texts["cell_base"]


@pytest.mark.parametrize(
    ("change", "reason"),
    [({"node": 1}, "node"), ({"more": []}, "more"), ({"schema": "rtron.cell/9"}, "schema")],
)
def test_a_wrong_manifest_is_refused_with_its_place(cell, tmp_path, change, reason):
    path = tmp_path / "cell.json"
    path.write_text(json.dumps({**json.loads(cell.texts()["cell_base.json"]), **change}))
    with pytest.raises(InputError, match=f"{path}: {reason}"):
        read_manifest(path)


@pytest.mark.parametrize("name", ["/rtron/cmd_vel/out", "//rtron/cmd_vel/out", "lamp", "/a*", ""])
@pytest.mark.parametrize("part", ["subscribed", "published", "served", "called"])
def test_a_manifest_does_not_lead_past_the_guard(cell, tmp_path, part, name):
    path = tmp_path / "cell.json"
    key = "topic" if part in ("subscribed", "published") else "service"
    document = json.loads(cell.texts()["cell_base.json"]) | {part: [{key: name}]}
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match="that the guard alone leads into the cell"):
        read_manifest(path)


def test_the_graph_of_a_guarded_app_does_not_lead_past_the_guard(cell):
    out, goal = "/rtron/cmd_vel/out", "/rtron/dock/out/goal"
    seen = [
        *ends(Direction.SUBSCRIBE, out, TWIST, BASE),
        *ends(Direction.PUBLISH, out, TWIST, "/rtron_guard"),
        *ends(Direction.SUBSCRIBE, goal, "std_msgs/String", BASE),
        *ends(Direction.PUBLISH, goal, "std_msgs/String", "/rtron_guard"),
    ]
    (again,) = plan_cells(replace(GRAPH, endpoints=(*GRAPH.endpoints, *seen)), PLAN)
    assert again.manifest == cell.manifest


def test_a_name_that_is_known_in_part_does_not_pass_and_is_noted():
    named = ends(Direction.PUBLISH, "/{side}/scan", "sensor_msgs/LaserScan", BASE)
    (cell,) = plan_cells(replace(GRAPH, endpoints=tuple(named)), PLAN)
    assert {each.topic for each in cell.manifest.published} == {"/rosout"}
    assert any(note.startswith("/{side}/scan does not pass") for note in cell.notes)


@pytest.mark.parametrize(
    ("topic", "type"),
    [
        ("/arm", "trajectory_msgs/JointTrajectory"),
        ("/wheels", "std_msgs/Float64MultiArray"),
        ("/dock/goal", "dock_msgs/DockActionGoal"),
        ("/dock/cancel", "actionlib_msgs/GoalID"),
    ],
)
def test_a_command_that_nobody_guards_does_not_pass(topic, type):
    heard = ends(Direction.SUBSCRIBE, topic, type, BASE)
    said = ends(Direction.PUBLISH, topic, type, "/switch")
    (cell,) = plan_cells(replace(GRAPH, endpoints=(*heard, *said)), PLAN)
    assert cell.manifest.subscribed == ()
    assert any(note.startswith(f"{topic} does not pass into") for note in cell.notes)


def test_what_is_dear_to_carry_is_noted():
    points = ends(Direction.PUBLISH, "/points", "sensor_msgs/PointCloud2", BASE)
    odom = ends(Direction.PUBLISH, "/odom", "nav_msgs/Odometry", BASE)
    (cell,) = plan_cells(replace(GRAPH, endpoints=(*points, *odom)), PLAN)
    dear = [note.split()[0] for note in cell.notes if "processor time" in note]
    assert dear == ["/points"]
    assert {"/points", "/odom"} < {each.topic for each in cell.manifest.published}


def test_two_cells_do_not_share_a_manifest():
    nodes = ("/a/b", "/a_b")
    plan = plan_of(grcn("/cmd_vel", ["/nav"], list(nodes)), cell=nodes)
    graph = InteractionGraph(app="app", nodes=tuple(Node(name=name) for name in nodes))
    with pytest.raises(InputError, match="the files of /a/b and /a_b have one name"):
        plan_cells(graph, plan)


def test_a_node_that_the_app_does_not_have_is_refused():
    with pytest.raises(InputError, match="the app has no node /base"):
        plan_cells(InteractionGraph(app="app", nodes=(Node(name="/bas"),)), PLAN)
