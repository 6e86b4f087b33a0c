"""Graphs of ROS 2 as NoDL and as rosgraph_msgs/Graph."""

from dataclasses import replace

import pytest
import yaml
from nodl_schema import faults

from rtron.errors import InputError
from rtron.reports.app.nodl import graph_to_nodl, nodl_files
from rtron.reports.app.rosgraph import graph_to_rosgraph
from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Durability,
    Endpoint,
    InteractionGraph,
    Node,
    NodeParameter,
    QoS,
    Reliability,
    Service,
    ServiceClient,
)

MUX, NAV = "/r/mux", "/r/nav"
TWIST, SCAN = "geometry_msgs/msg/Twist", "sensor_msgs/msg/LaserScan"
LATCHED = QoS(depth=1, durability=Durability.TRANSIENT_LOCAL, deadline=1_500_000_000)
SENSOR = QoS(depth=0, reliability=Reliability.BEST_EFFORT)


def end(node, topic, type, direction=Direction.PUBLISH, **keys):
    return Endpoint(node=node, topic=topic, type=type, direction=direction, **keys)


GRAPH = InteractionGraph(
    app="robot",
    ros=2,
    nodes=(Node(name=MUX, package="twist_mux", executable="twist_mux"), Node(name=NAV)),
    endpoints=(
        end(MUX, "/cmd_vel", TWIST, qos=LATCHED),
        end(MUX, "/nav_vel", TWIST, Direction.SUBSCRIBE, qos=SENSOR),
        end(MUX, "/rosout", "rcl_interfaces/msg/Log", implicit=True),
        end(NAV, "/{~prefix}/scan", SCAN, Direction.SUBSCRIBE),
        end(NAV, "/nav_vel", TWIST),
        end(NAV, "/relayed", ""),
    ),
    services=(
        Service(node=NAV, name="/r/plan", type="nav_msgs/srv/GetPlan"),
        Service(node=NAV, name="/r/nav/get_parameters", type="rcl_interfaces/srv/X", implicit=True),
    ),
    clients=(ServiceClient(node=MUX, name="/r/plan", type="nav_msgs/srv/GetPlan"),),
    actions=(
        Action(node=NAV, name="/go", type="nav2_msgs/action/Go", role=ActionRole.SERVER),
        Action(node=MUX, name="/go", type="nav2_msgs/action/Go", role=ActionRole.CLIENT),
    ),
    parameters=(
        NodeParameter(node=NAV, name="speed", value=0.5),
        NodeParameter(node=NAV, name="on", value=True),
        NodeParameter(node=NAV, name="plugins", value=("a", "b")),
        NodeParameter(node=NAV, name="mixed", value=("a", 1)),
        NodeParameter(node=NAV, name="unknown"),
    ),
)


def documents(graph=GRAPH):
    return list(yaml.safe_load_all(graph_to_nodl(graph)))


def test_each_node_is_a_document_of_the_schema():
    mux, nav = documents()
    assert faults(mux) == faults(nav) == []
    assert mux["description"] == "twist_mux/twist_mux"
    assert mux["publishers"] == [
        {
            "name": "/cmd_vel",
            "type": TWIST,
            "qos": {
                "history": "KEEP_LAST",
                "depth": 1,
                "reliability": "RELIABLE",
                "durability": "TRANSIENT_LOCAL",
                "liveliness": "AUTOMATIC",
                "deadline_ns": 1_500_000_000,
            },
        }
    ]
    assert mux["subscriptions"][0]["qos"]["history"] == "SYSTEM_DEFAULT"
    assert mux["subscriptions"][0]["qos"]["reliability"] == "BEST_EFFORT"
    assert mux["service_clients"] == [{"name": "/r/plan", "type": "nav_msgs/srv/GetPlan"}]
    assert mux["action_clients"] == nav["action_servers"]
    assert nav["service_servers"] == mux["service_clients"]
    assert nav["parameters"] == {
        "speed": {"type": "double", "default_value": 0.5},
        "on": {"type": "bool", "default_value": True},
        "plugins": {"type": "string_array", "default_value": ["a", "b"]},
    }


def test_what_is_not_known_stands_in_comments():
    text = graph_to_nodl(GRAPH)
    comments = [line for line in text.splitlines() if line.startswith("#")]
    assert comments == [
        '# node "/r/mux"',
        '# node "/r/nav"',
        '# not known: kind of parameter "mixed"',
        '# not known: kind of parameter "unknown"',
        '# not known: publisher "/relayed" ""',
        f'# not known: subscription "/{{~prefix}}/scan" "{SCAN}"',
    ]


def test_a_qos_that_is_not_known_is_the_systems_default():
    (nav,) = [one for one in documents() if "description" not in one]
    assert nav["publishers"][0]["qos"] == {
        "history": "SYSTEM_DEFAULT",
        "reliability": "SYSTEM_DEFAULT",
    }


def test_files_are_named_after_nodes():
    files = nodl_files(GRAPH)
    assert list(files) == ["r__mux.nodl.yaml", "r__nav.nodl.yaml"]
    assert yaml.safe_load(files["r__mux.nodl.yaml"]) == documents()[0]


@pytest.mark.parametrize(
    "name", ["/../../etc/x", "/a b", "/\n# x: 1", "/{a}", "", "/" + "x" * 5000]
)
def test_hostile_names_do_no_harm(name):
    nodes = (Node(name=name, package="a: b\n---", executable="\x1b[2J"), Node(name=f"{name}!"))
    parameters = (NodeParameter(node=name, name="x\n--- y", value="\n---\nz: 1"),)
    ends = (end(name, "/a\n- b", "c\nd"), end(name, "/ok", TWIST))
    graph = InteractionGraph(app="", ros=2, nodes=nodes, endpoints=ends, parameters=parameters)
    assert len(documents(graph)) == 2
    assert faults(documents(graph)[0]) == []
    assert "\x1b" not in graph_to_nodl(graph)
    files = nodl_files(graph)
    assert len(files) == 2
    assert all(len(file) < 255 and not set(file) & set("/\\\n ") for file in files)


def test_the_graph_has_the_fields_of_the_message():
    mux, nav = graph_to_rosgraph(GRAPH)["nodes"]
    assert set(mux) == {
        "name",
        "parameters",
        "parameter_values",
        "publishers",
        "subscriptions",
        "service_clients",
        "service_servers",
        "action_clients",
        "action_servers",
    }
    assert mux["publishers"] == [
        {
            "name": "/cmd_vel",
            "type": {"name": TWIST},
            "qos": {
                "depth": 1,
                "deadline": {"sec": 1, "nanosec": 500_000_000},
                "lifespan": {"sec": 0, "nanosec": 0},
                "history": 1,
                "reliability": 1,
                "durability": 1,
                "liveliness": 1,
                "liveliness_lease_duration": {"sec": 0, "nanosec": 0},
            },
        }
    ]
    assert nav["publishers"][0]["qos"] == {
        "history": 3,
        "reliability": 3,
        "durability": 3,
        "liveliness": 4,
    }
    assert nav["parameters"] == [
        {"name": "speed", "type": 3},
        {"name": "on", "type": 1},
        {"name": "plugins", "type": 9},
        {"name": "mixed", "type": 0},
        {"name": "unknown", "type": 0},
    ]
    assert nav["parameter_values"][:3] == [
        {"type": 3, "double_value": 0.5},
        {"type": 1, "bool_value": True},
        {"type": 9, "string_array_value": ["a", "b"]},
    ]
    goal = nav["action_servers"][0]["send_goal"]
    assert goal["name"] == "/go/_action/send_goal"
    assert goal["request_type"] == {"name": "nav2_msgs/action/Go_SendGoal"}


@pytest.mark.parametrize("shape", [graph_to_nodl, nodl_files, graph_to_rosgraph])
def test_ros1_has_neither(shape):
    with pytest.raises(InputError, match="ROS 1"):
        shape(replace(GRAPH, ros=1))
