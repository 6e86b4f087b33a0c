"""The functions of the nodes of an app: what is known, names, messages, and when they disagree."""

import pytest

from rtron.functions import node_functions as module
from rtron.functions.node_functions import (
    FunctionSource,
    NodeFunctions,
    combine_sources,
    functions_of_nodes,
    with_functions,
)
from rtron.functions.traffic_rules import NodeTraffic, functions_by_messages, node_traffic
from rtron.vocabulary import Action, ActionRole, Direction, Domain, Endpoint, InteractionGraph, Node
from rtron.vocabulary import FunctionType as F

TWIST, SCAN, IMAGE = "geometry_msgs/Twist", "sensor_msgs/LaserScan", "sensor_msgs/Image"
MAP, ODOM, PATH = "nav_msgs/OccupancyGrid", "nav_msgs/Odometry", "nav_msgs/Path"
GOAL = "move_base_msgs/MoveBaseActionGoal"
STATES = "gazebo_msgs/ModelStates"


def app(node, publishes=(), subscribes=(), actions=()):
    sides = ((Direction.PUBLISH, publishes), (Direction.SUBSCRIBE, subscribes))
    ends = tuple(
        Endpoint(node=node.name, topic=f"/{type}", type=type, direction=direction)
        for direction, types in sides
        for type in types
    )
    return InteractionGraph(app="app", nodes=(node,), endpoints=ends, actions=actions)


def node_functions(node, publishes=(), subscribes=(), description=""):
    graph = app(node, publishes, subscribes)
    return functions_of_nodes(graph, {node.package: description})[node.name]


@pytest.mark.parametrize(
    ("sends", "hears", "expected"),
    [
        ([MAP], [SCAN], (F.MAPPING,)),
        ([MAP], [], ()),
        ([MAP], [ODOM], ()),
        (["octomap_msgs/msg/Octomap"], ["sensor_msgs/msg/PointCloud2"], (F.MAPPING,)),
        ([MAP, TWIST], [SCAN], ()),
        ([MAP, GOAL], [SCAN], (F.GOAL_PLANNER,)),
        (["geometry_msgs/PoseWithCovarianceStamped"], [SCAN, MAP], (F.LOCALIZATION,)),
        ([ODOM], [TWIST], (F.MOBILE,)),
        ([ODOM, "rosgraph_msgs/Clock"], [TWIST], ()),
        ([ODOM, STATES], [TWIST], (F.VISUALIZATION,)),
        ([PATH], [MAP], (F.PATH_PLANNING,)),
        ([TWIST], [PATH], (F.PATH_TRACKING,)),
        ([TWIST, PATH], [GOAL, MAP], (F.PATH_PLANNING, F.PATH_TRACKING)),
        ([GOAL], [], (F.GOAL_PLANNER,)),
        ([TWIST], ["sensor_msgs/Joy"], (F.TELEOPERATION,)),
        ([TWIST], [], ()),
        ([TWIST], [SCAN], ()),
        ([SCAN], [], (F.SENSORS,)),
        ([SCAN, "tf2_msgs/TFMessage"], ["dynamic_reconfigure/Config"], (F.SENSORS,)),
        ([SCAN, "std_msgs/String"], [], ()),
        ([SCAN], [IMAGE], (F.PREPROCESSING,)),
        ([SCAN, "my_msgs/Own"], [IMAGE], ()),
        (["vision_msgs/Detection2DArray"], [IMAGE], (F.RECOGNITION,)),
        (["vision_msgs/Detection2DArray"], [], ()),
        (["std_msgs/String"], ["audio_common_msgs/AudioData"], (F.RECOGNITION,)),
        (["audio_common_msgs/AudioData"], ["std_msgs/String"], (F.SPEECH_GENERATION,)),
        ([PATH, "vision_msgs/Detection2DArray"], [MAP, IMAGE], ()),
        ([], [], ()),
        (["tf2_msgs/TFMessage"], [], ()),
    ],
)
def test_messages(sends, hears, expected):
    (traffic,) = node_traffic(app(Node(name="/n"), sends, hears)).values()
    assert functions_by_messages(traffic) == expected


def test_what_the_client_library_adds_is_not_the_nodes_own():
    clock = Endpoint(node="/n", topic="/x", type=SCAN, direction=Direction.PUBLISH, implicit=True)
    graph = InteractionGraph(app="a", nodes=(Node(name="/n"),), endpoints=(clock,))
    assert node_traffic(graph) == {"/n": NodeTraffic()}


@pytest.mark.parametrize(
    ("type", "expected"),
    [
        ("move_base_msgs/MoveBaseAction", "move_base_msgs/MoveBaseActionGoal"),
        ("nav2_msgs/action/NavigateToPose", "nav2_msgs/action/NavigateToPose"),
    ],
)
def test_an_action_is_asked_by_its_client_and_heard_by_its_server(type, expected):
    def traffic(role):
        action = Action(node="/n", name="/go", type=type, role=role)
        return node_traffic(app(Node(name="/n"), actions=(action,)))["/n"]

    assert traffic(ActionRole.CLIENT) == NodeTraffic(publishes=frozenset({expected}))
    assert traffic(ActionRole.SERVER) == NodeTraffic(subscribes=frozenset({expected}))


@pytest.mark.parametrize(
    ("pieces", "expected"),
    [
        ({}, NodeFunctions()),
        ({FunctionSource.PACKAGE: ()}, NodeFunctions()),
        (
            {FunctionSource.NAME: (F.MAPPING,)},
            NodeFunctions(functions=(F.MAPPING,), source=FunctionSource.NAME),
        ),
        (
            {FunctionSource.PACKAGE: (F.MAPPING,), FunctionSource.MESSAGES: (F.LOCALIZATION,)},
            NodeFunctions(source=FunctionSource.CONFLICT),
        ),
        (
            {
                FunctionSource.PACKAGE: (F.LOCALIZATION, F.MAPPING),
                FunctionSource.MESSAGES: (F.MAPPING,),
            },
            NodeFunctions(functions=(F.MAPPING,), source=FunctionSource.PACKAGE),
        ),
        (
            {FunctionSource.PACKAGE: (F.LOCALIZATION, F.MAPPING)},
            NodeFunctions(
                functions=(F.LOCALIZATION, F.MAPPING),
                source=FunctionSource.PACKAGE,
                is_certain=False,
            ),
        ),
        (
            {FunctionSource.MESSAGES: (F.PATH_PLANNING, F.PATH_TRACKING)},
            NodeFunctions(
                functions=(F.PATH_PLANNING, F.PATH_TRACKING), source=FunctionSource.MESSAGES
            ),
        ),
        (
            {FunctionSource.PACKAGE: (F.EXTENSION,), FunctionSource.MESSAGES: (F.MAPPING,)},
            NodeFunctions(functions=(F.MAPPING,), source=FunctionSource.MESSAGES),
        ),
        (
            {FunctionSource.PACKAGE: (F.SUPPORT,)},
            NodeFunctions(functions=(F.SUPPORT,), source=FunctionSource.PACKAGE),
        ),
        (
            {
                FunctionSource.PACKAGE: (F.MOBILE,),
                FunctionSource.NAME: (F.MAPPING,),
                FunctionSource.MESSAGES: (F.MAPPING,),
            },
            NodeFunctions(functions=(F.MAPPING,), source=FunctionSource.NAME),
        ),
        (
            {
                FunctionSource.PACKAGE: (F.MOBILE,),
                FunctionSource.NAME: (F.MAPPING,),
                FunctionSource.MESSAGES: (F.SENSORS,),
            },
            NodeFunctions(source=FunctionSource.CONFLICT),
        ),
    ],
)
def test_pieces_that_agree_decide(pieces, expected):
    assert combine_sources(pieces) == expected


def test_function_and_domain_of_one_that_is_not_sure():
    both = NodeFunctions(functions=(F.LOCALIZATION, F.MAPPING), is_certain=False)
    apart = NodeFunctions(functions=(F.MOBILE, F.MAPPING), is_certain=False)
    assert (both.function, both.domain) == (None, Domain.PERCEPTION)
    assert (apart.function, apart.domain) == (None, None)
    sure = NodeFunctions(functions=(F.MOBILE, F.MAPPING))
    assert (sure.function, sure.domain) == (F.MOBILE, Domain.DRIVERS)


@pytest.mark.parametrize(
    ("node", "expected"),
    [
        (Node(name="/n", package="amcl"), (F.LOCALIZATION,)),
        (Node(name="/ns/amcl"), (F.LOCALIZATION,)),
        (Node(name="/amcl", package="nodelet"), (F.LOCALIZATION,)),
        (Node(name="/n", package="topic_tools", executable="mux"), (F.SWITCHER,)),
        (Node(name="/relay", package="topic_tools"), (F.EXTENSION,)),
        (Node(name="/nav", package="move_base"), (F.PATH_PLANNING, F.PATH_TRACKING)),
    ],
)
def test_well_known_nodes(node, expected):
    found = node_functions(node)
    assert (found.functions, found.source) == (expected, FunctionSource.KNOWN)


def test_a_known_name_of_another_package_is_not_known():
    assert node_functions(Node(name="/amcl", package="my_own")).source is not FunctionSource.KNOWN


def test_a_package_is_told_by_its_description():
    node = Node(name="/n", package="qwert")
    assert node_functions(node).functions == ()
    found = node_functions(
        node, description="Detects and recognizes faces of people in camera images."
    )
    assert (found.function, found.source) == (F.RECOGNITION, FunctionSource.PACKAGE)


def test_a_robots_name_makes_no_driver_of_a_node_that_takes_no_command():
    node = Node(name="/x", package="qwert")
    words = "Driver for the mobile base"
    assert node_functions(node, description=words).function is F.MOBILE
    assert node_functions(node, [ODOM], [TWIST], words).function is F.MOBILE
    assert node_functions(node, ["std_msgs/UInt8"], ["std_msgs/UInt8"], words).function is None


def test_a_nodes_own_name_counts_with_messages_of_the_kind():
    node = Node(name="/detect_lane")
    assert node_functions(node).function is F.RECOGNITION
    assert node_functions(node, ["std_msgs/Float64"], [IMAGE]).function is F.RECOGNITION
    assert node_functions(node, ["std_msgs/Float64"], ["std_msgs/Float64"]).function is None


def test_each_name_is_asked_once_whatever_its_number(monkeypatch):
    asked = []
    monkeypatch.setattr(module, "classify_name", lambda *name: asked.append(name) or ())
    crowd = tuple(Node(name=f"/n_{number}", package="pack") for number in range(5))
    functions_of_nodes(InteractionGraph(app="a", nodes=crowd), {"pack": "words"})
    assert asked == [("pack", "words"), ("n", "")]


def test_a_robots_name_alone_makes_no_driver_of_a_node():
    assert node_functions(Node(name="/mobile_base_driver", package="nodelet")).function is None
    found = node_functions(Node(name="/mobile_base_driver", package="nodelet"), [ODOM], [TWIST])
    assert found.function is F.MOBILE


@pytest.mark.parametrize(
    ("sends", "hears", "expected", "sure"),
    [
        ([], [], (F.PATH_PLANNING, F.RECOGNITION), False),
        (["trajectory_msgs/JointTrajectory"], [IMAGE], (F.PATH_PLANNING, F.RECOGNITION), False),
        ([], [IMAGE], (F.RECOGNITION,), True),
        (["trajectory_msgs/JointTrajectory"], [], (F.PATH_PLANNING,), True),
        (["std_msgs/UInt8"], [], (), True),
    ],
)
def test_of_a_packages_functions_those_that_the_messages_fit(
    monkeypatch, sends, hears, expected, sure
):
    both = {"both": (F.PATH_PLANNING, F.RECOGNITION)}
    monkeypatch.setattr(module, "classify_name", lambda name, _="": both.get(name, ()))
    found = node_functions(Node(name="/n", package="both"), sends, hears)
    assert (found.functions, found.is_certain) == (expected, sure)


def test_a_function_that_is_given_stays():
    node = Node(name="/amcl", package="amcl", function=F.MAPPING, domain=Domain.OTHERS)
    (found,) = with_functions(app(node)).nodes
    assert (found.function, found.domain) == (F.MAPPING, Domain.OTHERS)


def test_the_graph_is_otherwise_as_it_was_and_a_second_time_changes_nothing():
    graph = app(Node(name="/amcl", package="amcl"), [ODOM], [SCAN])
    once = with_functions(graph)
    assert once.nodes == (
        Node(name="/amcl", package="amcl", function=F.LOCALIZATION, domain=Domain.PERCEPTION),
    )
    assert (once.endpoints, once.app) == (graph.endpoints, graph.app)
    assert with_functions(once) == once


def test_a_given_function_keeps_the_others_that_fit_to_it():
    node = Node(name="/foo")
    graph = app(node, publishes=[TWIST], subscribes=[GOAL, SCAN])
    first = functions_of_nodes(graph)["/foo"].functions
    again = functions_of_nodes(with_functions(graph))["/foo"].functions
    assert again == first == (F.PATH_PLANNING, F.PATH_TRACKING)


def test_a_given_function_stands_alone_where_nothing_fits_to_it():
    node = Node(name="/foo", function=F.SPEAKER)
    found = functions_of_nodes(app(node, publishes=[TWIST], subscribes=[GOAL, SCAN]))["/foo"]
    assert found == NodeFunctions(functions=(F.SPEAKER,), source=FunctionSource.DECLARED)
