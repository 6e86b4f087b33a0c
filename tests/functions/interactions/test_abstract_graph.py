"""Which functions interact, and how that is known (paper 3.2)."""

import pytest

from rtron.functions.interactions.abstract_graph import Basis, PackageMessages, abstract_graph
from rtron.vocabulary import FunctionType as F
from rtron.vocabulary import RecognitionSubfunction as Sub

TWIST, SCAN, PATH = "geometry_msgs/Twist", "sensor_msgs/LaserScan", "nav_msgs/Path"


def use(name, *functions, publishes=(), subscribes=(), depends=(), description=""):
    return PackageMessages(
        name=name,
        description=description,
        functions=functions,
        publishes=frozenset(publishes),
        subscribes=frozenset(subscribes),
        depends=frozenset(depends),
    )


def direct(*packages):
    return {(e.source, e.target): e.messages for e in abstract_graph(packages).direct}


def indirect(*packages):
    return {(e.source, e.target): e.through for e in abstract_graph(packages).indirect}


def test_no_package_gives_an_empty_graph():
    graph = abstract_graph([])
    assert (graph.functions, graph.direct, graph.indirect, graph.packages) == ((), (), (), 0)


def test_the_papers_example_path_planning_to_path_tracking():
    found = direct(use("plans", F.PATH_PLANNING), use("follows", F.PATH_TRACKING))
    (path, *_) = found["Path Planning", "Path Tracking"]
    assert (path.type, path.basis) == (PATH, Basis.TYPICAL)
    assert (path.publishers, path.subscribers) == (0, 0)


def test_a_function_that_is_absent_has_no_edges():
    graph = abstract_graph([use("plans", F.PATH_PLANNING)])
    assert [node.name for node in graph.functions] == ["Path Planning"]
    assert graph.direct == ()


def test_both_sides_in_source_are_counted():
    found = direct(
        use("a", F.PATH_TRACKING, publishes=[TWIST]),
        use("b", F.PATH_TRACKING, publishes=["geometry_msgs/msg/Twist"]),
        use("c", F.MOBILE, subscribes=[TWIST]),
    )
    (first, *_) = found["Path Tracking", "Mobile"]
    assert (first.type, first.basis, first.publishers, first.subscribers) == (
        TWIST,
        Basis.SOURCE,
        2,
        1,
    )


def test_one_side_in_source_is_not_enough_for_an_untypical_type():
    odd = "my_msgs/Odd"
    assert direct(use("a", F.MAPPING, publishes=[odd]), use("b", F.SPEAKER)) == {}
    found = direct(use("a", F.MAPPING, publishes=[odd]), use("b", F.SPEAKER, subscribes=[odd]))
    assert [m.type for m in found["Mapping", "Speaker"]] == [odd]


@pytest.mark.parametrize(
    ("sender", "hearer", "basis"),
    [
        ((), (), Basis.TYPICAL),
        (("geometry_msgs",), (), Basis.TYPICAL),
        ((), ("geometry_msgs",), Basis.TYPICAL),
        (("geometry_msgs",), ("geometry_msgs",), Basis.MANIFEST),
        (("nav_msgs",), ("geometry_msgs",), Basis.TYPICAL),
    ],
)
def test_dependencies_on_both_sides_are_a_hint(sender, hearer, basis):
    found = direct(use("a", F.TELEOPERATION, depends=sender), use("b", F.MOBILE, depends=hearer))
    (first,) = found["Teleoperation", "Mobile"]
    assert (first.type, first.basis) == (TWIST, basis)


def test_source_on_one_side_and_a_dependency_on_the_other_is_a_hint():
    found = direct(
        use("a", F.TELEOPERATION, publishes=[TWIST]), use("b", F.MOBILE, depends=["geometry_msgs"])
    )
    (first,) = found["Teleoperation", "Mobile"]
    assert first.basis is Basis.MANIFEST
    assert (first.publishers, first.from_depends) == (1, 0)
    assert (first.subscribers, first.to_depends) == (0, 1)


def test_dependants_count_apart_from_what_was_read():
    found = direct(
        use("a", F.TELEOPERATION, publishes=[TWIST], depends=["geometry_msgs"]),
        use("b", F.TELEOPERATION, depends=["geometry_msgs"]),
        use("c", F.MOBILE, subscribes=[TWIST]),
    )
    (first,) = found["Teleoperation", "Mobile"]
    assert (first.basis, first.sides) == (Basis.SOURCE, (1, 1))
    assert (first.from_depends, first.to_depends) == (2, 0)


def test_types_are_counted_by_how_they_are_known():
    graph = abstract_graph(
        [
            use("a", F.PATH_TRACKING, publishes=[TWIST], depends=["ackermann_msgs"]),
            use("b", F.MOBILE, subscribes=[TWIST], depends=["ackermann_msgs"]),
            use("c", F.MANIPULATOR),
        ]
    )
    read, told, assumed = (graph.count_by_basis()[basis] for basis in Basis)
    assert (read, told) == (1, 1)
    assert assumed == sum(len(e.messages) for e in graph.direct) - 2 > 0


NAVIGATE = "nav2_msgs/action/NavigateToPose"


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ((), False),
        ((use("roscpp"), use("x", depends=["roscpp", "catkin"])), False),
        ((use("rclcpp"),), True),
        ((use("x", depends=["rclpy"]),), True),
    ],
)
def test_types_of_ros_2_are_typical_only_where_it_is(more, expected):
    found = direct(use("bt", F.GOAL_PLANNER), use("plans", F.PATH_PLANNING), *more)
    types = [m.type for m in found["Goal Planner", "Path Planning"]]
    assert (NAVIGATE in types) is expected
    assert "move_base_msgs/MoveBaseActionGoal" in types


def test_a_type_of_ros_2_that_is_read_counts_without_its_packages():
    found = direct(
        use("bt", F.GOAL_PLANNER, publishes=[NAVIGATE]),
        use("p", F.PATH_PLANNING, subscribes=[NAVIGATE]),
    )
    (first, *_) = found["Goal Planner", "Path Planning"]
    assert (first.type, first.basis) == (NAVIGATE, Basis.SOURCE)


@pytest.mark.parametrize("type", ["std_msgs/String", "std_msgs/Float64"])
def test_a_type_without_meaning_joins_nobody_by_itself(type):
    assert (
        direct(use("a", F.MAPPING, publishes=[type]), use("b", F.PATH_TRACKING, subscribes=[type]))
        == {}
    )


def test_a_type_without_meaning_joins_where_it_is_typical():
    found = direct(use("a", F.GOAL_PLANNER), use("b", F.SPEECH_GENERATION))
    assert [m.type for m in found["Goal Planner", "Speech Generation"]] == ["std_msgs/String"]


@pytest.mark.parametrize("type", ["tf2_msgs/TFMessage", "visualization_msgs/Marker", ""])
def test_types_that_tell_no_state_are_left_out(type):
    assert (
        direct(use("a", F.MAPPING, publishes=[type]), use("b", F.SPEAKER, subscribes=[type])) == {}
    )


def test_a_function_does_not_interact_with_itself():
    assert (
        direct(use("a", F.MOBILE, publishes=[TWIST]), use("b", F.MOBILE, subscribes=[TWIST])) == {}
    )


def test_raw_data_pass_through_preprocessing_where_there_is_any():
    packages = [
        use("lidar", F.SENSORS, publishes=[SCAN]),
        use("maps", F.MAPPING, subscribes=[SCAN]),
    ]
    assert ("Sensors", "Mapping") in direct(*packages)
    found = direct(*packages, use("filters", F.PREPROCESSING))
    assert ("Sensors", "Mapping") not in found
    assert {("Sensors", "Preprocessing"), ("Preprocessing", "Mapping")} <= found.keys()


def test_what_preprocessing_does_not_hand_on_comes_from_the_sensor():
    found = direct(
        use("gps", F.SENSORS), use("filters", F.PREPROCESSING), use("ekf", F.LOCALIZATION)
    )
    assert [m.type for m in found["Sensors", "Localization"]] == ["sensor_msgs/NavSatFix"]


def test_typical_types_do_not_flow_back_but_from_drivers():
    found = direct(
        use("tts", F.SPEECH_GENERATION),
        use("asr", F.RECOGNITION),
        use("base", F.MOBILE),
        use("amcl", F.LOCALIZATION),
    )
    assert set(found) == {("Mobile", "Localization"), ("Speech Recognition", "Speech Generation")}


def test_what_is_read_in_source_may_flow_back():
    found = direct(
        use("a", F.PATH_PLANNING, publishes=[SCAN]), use("b", F.PREPROCESSING, subscribes=[SCAN])
    )
    assert ("Path Planning", "Preprocessing") in found


def test_types_of_a_package_with_several_functions_go_to_the_typical_one():
    slam = use(
        "slam", F.LOCALIZATION, F.MAPPING, publishes=["nav_msgs/OccupancyGrid", "x_msgs/Own"]
    )
    found = direct(
        slam, use("p", F.PATH_PLANNING, subscribes=["nav_msgs/OccupancyGrid", "x_msgs/Own"])
    )
    read = {
        key: [m.type for m in messages if m.basis is Basis.SOURCE]
        for key, messages in found.items()
    }
    assert read["Mapping", "Path Planning"] == ["nav_msgs/OccupancyGrid"]
    assert read["Localization", "Path Planning"] == ["x_msgs/Own"]


def test_the_best_known_types_come_first():
    found = direct(
        use("a", F.PATH_TRACKING, publishes=["x_msgs/B", "x_msgs/A"]),
        use("c", F.PATH_TRACKING, publishes=["x_msgs/B"]),
        use("b", F.MOBILE, subscribes=["x_msgs/A", "x_msgs/B"]),
        use("d", F.MOBILE, subscribes=["x_msgs/B"]),
    )
    types = [m.type for m in found["Path Tracking", "Mobile"]]
    assert types == ["x_msgs/B", "x_msgs/A", "ackermann_msgs/AckermannDriveStamped", TWIST]


def test_control_reaches_perception_through_the_environment():
    found = indirect(
        use("t", F.PATH_TRACKING),
        use("a", F.LOCALIZATION),
        use("p", F.PATH_PLANNING),
        use("m", F.MOBILE),
    )
    assert found == {
        ("Path Tracking", "Localization"): "motion",
        ("Path Tracking", "Path Planning"): "motion",
    }


def test_a_voice_is_heard_not_seen():
    packages = [
        use("tts", F.SPEECH_GENERATION),
        use("speech_recognition", F.RECOGNITION),
        use("face_detector", F.RECOGNITION),
    ]
    assert indirect(*packages) == {("Speech Generation", "Speech Recognition"): "sound"}


@pytest.mark.parametrize(
    ("name", "description", "hears", "expected"),
    [
        ("face_detector", "", (), Sub.IMAGE),
        ("pocketsphinx", "", (), Sub.SPEECH),
        ("find_object_2d", "", (), Sub.OBJECT),
        ("my_pkg", "Watches the temperature of a room", (), Sub.TEMPERATURE),
        ("my_pkg", "", ("sensor_msgs/RelativeHumidity",), Sub.HUMIDITY),
        ("my_pkg", "", ("sensor_msgs/Illuminance",), Sub.ILLUMINANCE),
        ("my_pkg", "", ("sensor_msgs/msg/Image",), Sub.IMAGE),
        ("my_pkg", "", ("nav_msgs/Path",), None),
        ("facepalm", "", (), None),
    ],
)
def test_recognition_is_split_where_it_is_known(name, description, hears, expected):
    graph = abstract_graph([use(name, F.RECOGNITION, description=description, subscribes=hears)])
    (node,) = graph.functions
    assert node.name == (expected.value if expected else "Recognition")
    assert node.function is F.RECOGNITION


def test_other_functions_are_outside():
    graph = abstract_graph(
        [use("rviz", F.VISUALIZATION), use("nothing"), use("both", F.EXTENSION, F.MAPPING)]
    )
    assert (graph.packages, graph.outside) == (3, 2)
    assert [(node.name, node.packages) for node in graph.functions] == [("Mapping", 1)]


def test_all_functions_close_the_loop():
    """The paper: the graph gives a complete closed-loop robot operation."""
    graph = abstract_graph([use(f.name.lower(), f) for f in F])
    ends = {(e.source, e.target) for e in (*graph.direct, *graph.indirect)}
    reached, waiting = {"Sensors"}, ["Sensors"]
    while waiting:
        here = waiting.pop()
        for source, target in ends:
            if source == here and target not in reached:
                reached.add(target)
                waiting.append(target)
    fed_by_hand = {"Teleoperation"}
    assert reached | fed_by_hand == {node.name for node in graph.functions}
    assert {source for source, _ in ends} | {"Speaker"} >= reached
