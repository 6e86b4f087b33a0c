"""The graph of a bag: who published what, and what a bag cannot tell."""

import pytest
from bag_files import (
    add_ros1_connection,
    channel,
    qos,
    ros1_bag,
    ros2_bag,
    schema,
    twist,
    write_mcap_records,
)
from rosbags.rosbag1 import Writer as Writer1

from rtron.errors import InputError
from rtron.risks import discover_risks
from rtron.sources.bag.graph import BagSource
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Durability,
    Evidence,
    QoS,
    Resolution,
    RiskKind,
    Topic,
)


def recorded(path, *publishers):
    """Write a bag with a message of each (node, topic, type)."""
    with Writer1(path) as writer:
        for time, (node, topic, type) in enumerate(publishers, 1):
            writer.write(add_ros1_connection(writer, topic, type, callerid=node), time, twist(0))
    return BagSource(path).read()


def unresolved(graph):
    return {each.what: each.why for each in graph.unresolved}


def test_publishers_are_those_of_the_connections(tmp_path):
    path = tmp_path / "run.bag"
    with Writer1(path) as writer:
        for node, topic, latching in (
            ("/planner", "/cmd_vel", 0),
            ("/keyboard", "/cmd_vel", 0),
            ("/map_server", "/map", 1),
            ("/map_server", "/rosout", 0),
        ):
            stream = add_ros1_connection(writer, topic, callerid=node, latching=latching)
            writer.write(stream, 1, twist(0))
    graph = BagSource(path).read()
    assert (graph.app, graph.ros) == ("run.bag", 1)
    assert [node.name for node in graph.nodes] == ["/planner", "/keyboard", "/map_server"]
    assert [each.node for each in graph.publishers("/cmd_vel")] == ["/planner", "/keyboard"]
    (map_end,) = graph.publishers("/map")
    assert map_end.direction is Direction.PUBLISH
    assert map_end.type == "geometry_msgs/Twist"
    assert map_end.resolution is Resolution.OBSERVED
    assert map_end.qos == QoS(durability=Durability.TRANSIENT_LOCAL)
    assert map_end.evidence == (Evidence(file=str(path)),)
    assert not map_end.implicit
    assert graph.publishers("/cmd_vel")[0].qos is None
    assert graph.publishers("/rosout")[0].implicit
    assert graph.topics[0] == Topic(name="/cmd_vel", types=("geometry_msgs/Twist",))
    assert list(unresolved(graph)) == ["subscribers"]


def test_a_node_that_came_back_is_one(tmp_path):
    path = tmp_path / "run.bag"
    with Writer1(path) as writer:
        for latching in (None, 0):
            stream = add_ros1_connection(writer, callerid="/a", latching=latching)
            writer.write(stream, 1, twist(0))
    assert len(BagSource(path).read().endpoints) == 1


def test_a_topic_with_two_types_has_both(tmp_path):
    graph = recorded(
        tmp_path / "x.bag", ("/a", "/t", "std_msgs/msg/Int8"), ("/b", "/t", "std_msgs/msg/Bool")
    )
    assert graph.topics == (Topic(name="/t", types=("std_msgs/Int8", "std_msgs/Bool")),)


def test_a_connection_without_caller_names_no_publisher(tmp_path):
    graph = recorded(tmp_path / "x.bag", (None, "/t", "std_msgs/msg/Int8"))
    assert (graph.nodes, graph.endpoints) == ((), ())
    assert graph.topics == (Topic(name="/t", types=("std_msgs/Int8",)),)
    assert unresolved(graph)["/t"] == "the bag does not name its publisher"


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_ros2_bag_names_topics_only(tmp_path, storage):
    path = ros2_bag(tmp_path / "run", storage, offered_qos_profiles=[qos(), qos()])
    graph = BagSource(path).read()
    assert (graph.app, graph.ros) == ("run", 2)
    assert (graph.nodes, graph.endpoints) == ((), ())
    type = ("geometry_msgs/msg/Twist",)
    assert graph.topics == (
        Topic(name="/cmd_vel", types=type),
        Topic(name="/other/cmd_vel", types=type),
    )
    why = "the bag does not name its publishers, only that there were 2"
    assert unresolved(graph)["/cmd_vel"] == why
    assert graph.unresolved[0].evidence == (Evidence(file=str(path)),)
    assert discover_risks(graph).risks == ()


def test_an_mcap_of_ros1_and_a_channel_that_is_not_of_ros(tmp_path):
    summary = schema() + channel(metadata={"callerid": "/a"})
    summary += channel(id=2, topic="/json", encoding="json")
    graph = BagSource(write_mcap_records(tmp_path / "x.mcap", summary)).read()
    assert graph.ros == 1
    assert [each.node for each in graph.publishers("/cmd_vel")] == ["/a"]
    assert "'json'" in unresolved(graph)["/json"]


def action_topics(space, goal="move_base_msgs/msg/MoveBaseActionGoal"):
    return {
        "goal": ("/client", f"{space}/goal", goal),
        "cancel": ("/client", f"{space}/cancel", "actionlib_msgs/msg/GoalID"),
        "status": ("/server", f"{space}/status", "actionlib_msgs/msg/GoalStatusArray"),
        "feedback": ("/server", f"{space}/feedback", "x/msg/Y"),
        "result": ("/server", f"{space}/result", "x/msg/Y"),
    }


CLIENT = Action(
    node="/client", name="/go", type="move_base_msgs/MoveBaseAction", role=ActionRole.CLIENT
)
SERVER = Action(
    node="/server", name="/go", type="move_base_msgs/MoveBaseAction", role=ActionRole.SERVER
)


@pytest.mark.parametrize(
    ("recorded_parts", "actions"),
    [
        (["goal", "cancel", "status", "feedback", "result"], {CLIENT, SERVER}),
        (["goal", "status", "feedback", "result"], {CLIENT, SERVER}),
        (["goal", "status"], {CLIENT, SERVER}),
        (["goal"], {CLIENT}),
        (["cancel"], set()),
        (["feedback", "result"], set()),
    ],
)
def test_an_action_is_known_by_what_was_sent(tmp_path, recorded_parts, actions):
    topics = action_topics("/go")
    graph = recorded(tmp_path / "x.bag", *(topics[part] for part in recorded_parts))
    assert set(graph.actions) == actions
    assert len(graph.actions) == len(actions)
    assert len(graph.endpoints) == len(recorded_parts)


def test_a_goal_alone_is_no_action_without_its_type(tmp_path):
    goal = action_topics("/go", goal="geometry_msgs/msg/PoseStamped")["goal"]
    assert recorded(tmp_path / "x.bag", goal).actions == ()


def test_risks_that_need_no_subscriber_are_found(tmp_path):
    graph = recorded(tmp_path / "x.bag", ("/odometry", "/odom", "nav_msgs/msg/Odometry"))
    assert [risk.kind for risk in discover_risks(graph).risks] == [RiskKind.MSR]


def test_the_graph_can_be_written(tmp_path):
    graph = BagSource(ros1_bag(tmp_path / "x.bag")).read()
    assert graph_to_json(graph)["endpoints"][0]["resolution"] == "observed"


def test_what_is_no_bag(tmp_path):
    with pytest.raises(InputError, match=r"x\.bag: No such file"):
        BagSource(tmp_path / "x.bag").read()
