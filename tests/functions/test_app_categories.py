"""The paper's table of apps, and the apps that its appendix describes."""

import pytest

from rtron.functions import node_functions
from rtron.functions.app_categories import (
    AppProfile,
    app_profile,
    categories,
    categories_of,
    count_categories,
    nearest_category,
)
from rtron.vocabulary import Direction, Endpoint, InteractionGraph, Node
from rtron.vocabulary import FunctionType as F

NAVIGATES = {F.PREPROCESSING, F.LOCALIZATION, F.PATH_PLANNING, F.PATH_TRACKING, F.MOBILE}
DESCRIBED = {
    "Remote Control": {F.TELEOPERATION, F.MOBILE},
    "2D/3D Mapping": {F.TELEOPERATION, F.PREPROCESSING, F.MAPPING, F.MOBILE},
    "Navigation": NAVIGATES,
    "SLAM": NAVIGATES | {F.MAPPING},
}


def test_the_paper_has_14_categories_of_110_apps():
    assert len(categories()) == 14
    assert sum(category.apps for category in categories()) == 110


@pytest.mark.parametrize(("name", "present"), DESCRIBED.items())
def test_the_apps_that_the_appendix_describes(name, present):
    assert categories_of(present) == (name,)


def test_face_detection_shares_its_set_with_object_detection():
    found = categories_of({F.PREPROCESSING, F.RECOGNITION})
    assert found == ("Face/Person Detection", "Object/Scene Detection")


@pytest.mark.parametrize("category", categories(), ids=lambda category: category.name)
def test_an_app_of_just_a_categorys_functions_is_of_it(category):
    present = category.functions | set(sorted(category.one_of)[:1])
    assert category.name in categories_of(present)


@pytest.mark.parametrize("category", categories(), ids=lambda category: category.name)
def test_an_app_that_lacks_one_function_is_not_of_it(category):
    for missing in category.functions:
        assert category.name not in categories_of(set(F) - {missing})
    if category.one_of:
        assert category.name not in categories_of(set(F) - category.one_of)


def test_no_functions_are_no_category():
    assert categories_of(()) == ()
    assert categories_of({F.VISUALIZATION, F.EXTENSION}) == ()


def test_functions_outside_the_table_change_nothing():
    more = NAVIGATES | {F.VISUALIZATION, F.SUPPORT, F.EXTENSION, F.SENSORS}
    assert categories_of(more) == ("Navigation",)


def test_two_robots_in_one_are_of_both_kinds_the_larger_first():
    found = categories_of({F.TELEOPERATION, F.MANIPULATOR, *NAVIGATES})
    assert found == ("Navigation", "Manipulation", "Remote Control")


def test_a_remote_control_of_either_kind_of_robot():
    assert categories_of({F.TELEOPERATION, F.MANIPULATOR}) == ("Remote Control",)
    assert categories_of({F.TELEOPERATION}) == ()


def graph(*nodes, links=()):
    directions = {"->": Direction.PUBLISH, "<-": Direction.SUBSCRIBE}
    ends = tuple(
        Endpoint(node=node, topic=f"/{type}", type=type, direction=directions[arrow])
        for node, arrow, type in links
    )
    return InteractionGraph(app="app", nodes=nodes, endpoints=ends)


SLAM_NODES = (
    Node(name="/slam", package="gmapping"),
    Node(name="/move_base", package="move_base"),
    Node(name="/gazebo", package="gazebo_ros"),
)
SLAM_LINKS = (
    ("/slam", "<-", "sensor_msgs/LaserScan"),
    ("/slam", "->", "nav_msgs/OccupancyGrid"),
    ("/gazebo", "->", "sensor_msgs/LaserScan"),
    ("/gazebo", "<-", "geometry_msgs/Twist"),
)


def test_a_simulated_robot_has_the_drivers_that_its_simulator_stands_in_for():
    row = app_profile(graph(*SLAM_NODES, links=SLAM_LINKS))
    assert row.categories == ("SLAM",)
    assert row.functions[F.MOBILE] == ("/gazebo",)
    assert row.functions[F.PREPROCESSING] == ("/gazebo",)


def test_a_simulator_that_takes_no_command_drives_nothing():
    row = app_profile(graph(*SLAM_NODES, links=SLAM_LINKS[:3]))
    assert F.MOBILE not in row.functions
    assert row.categories == ("Panorama",)


def test_a_map_that_is_only_handed_out_is_no_mapping():
    nodes = (*SLAM_NODES[1:], Node(name="/amcl", package="amcl"))
    served = Node(name="/map", package="map_server")
    links = (*SLAM_LINKS[2:], ("/map", "->", "nav_msgs/OccupancyGrid"))
    assert app_profile(graph(*nodes, served, links=links)).categories == ("Navigation",)


def test_of_functions_that_are_not_sure_those_count_that_the_node_speaks_as(monkeypatch):
    monkeypatch.setattr(
        node_functions, "classify_name", lambda name, _="": (F.PATH_PLANNING, F.RECOGNITION)
    )
    links = (("/n", "->", "trajectory_msgs/JointTrajectory"), ("/n", "<-", "sensor_msgs/Image"))
    row = app_profile(graph(Node(name="/n", package="both"), links=links))
    assert row.functions == {F.PATH_PLANNING: ("/n",)}


def test_the_app_is_named_by_its_graph_or_as_told():
    assert app_profile(graph()).app == "app"
    assert app_profile(graph(), "told").app == "told"
    assert app_profile(InteractionGraph(app="")).app == "app"


def test_counts_join_the_categories_that_share_a_set():
    rows = [
        AppProfile(app="a", functions={}, categories=("Object Search", "Autonomous Driving")),
        AppProfile(app="b", functions={}, categories=("Navigation", "Remote Control")),
        AppProfile(app="c", functions={}, categories=()),
    ]
    found = {each.categories: (each.apps, each.paper) for each in count_categories(rows)}
    assert len(found) == 12
    assert found["Object Search", "Autonomous Driving"] == (1, 2)
    assert found["Face/Person Detection", "Object/Scene Detection"] == (0, 13)
    assert found["Navigation",] == (1, 22)
    assert found["Remote Control",] == (0, 23)


@pytest.mark.parametrize(
    ("present", "category", "missing"),
    [
        (NAVIGATES - {F.MOBILE}, "Navigation", (F.MOBILE,)),
        ({F.LOCALIZATION, F.MAPPING}, "SLAM", None),
        ({F.RECOGNITION}, "Face/Person Detection", (F.PREPROCESSING,)),
    ],
)
def test_an_app_of_no_category_is_told_the_nearest(present, category, missing):
    found = nearest_category(present)
    assert found.categories[0] == category
    lacks = {c.name: c.functions for c in categories()}[category] - present
    assert set(found.missing.missing) == lacks
    assert missing is None or found.missing.missing == missing


def test_categories_of_one_set_are_near_together():
    found = nearest_category({F.RECOGNITION})
    assert found.categories == ("Face/Person Detection", "Object/Scene Detection")


def test_what_only_lacks_one_of_several_is_told_which():
    """turtlebot3_teleop_key: a launch file of the teleoperation alone."""
    found = nearest_category({F.TELEOPERATION})
    assert found.categories == ("Remote Control",)
    assert (found.missing.missing, found.missing.one_of) == ((), (F.MOBILE, F.MANIPULATOR))


def test_one_of_several_counts_as_one_function():
    found = nearest_category({F.MANIPULATOR})
    assert found.categories == ("Remote Control",)
    assert (found.missing.missing, found.missing.one_of) == ((F.TELEOPERATION,), ())
    speaks = nearest_category({F.PREPROCESSING, F.SPEECH_GENERATION, F.SPEAKER})
    assert speaks.categories == ("Voice Interaction",)
    assert (speaks.missing.missing, speaks.missing.one_of) == ((F.RECOGNITION,), ())


DRIVES_ITSELF = {F.PREPROCESSING, F.RECOGNITION, F.PATH_TRACKING, F.GOAL_PLANNER}


def test_an_app_of_a_small_category_is_told_the_larger_one_that_it_nearly_is():
    found = nearest_category(DRIVES_ITSELF)
    assert found.categories == ("Object Search", "Autonomous Driving")
    assert found.missing.missing == (F.LOCALIZATION, F.PATH_PLANNING, F.MOBILE)


@pytest.mark.parametrize("present", [NAVIGATES, NAVIGATES | {F.TELEOPERATION}, set(F)])
def test_a_category_that_fits_as_well_is_the_nearest_so_none_is_told(present):
    assert nearest_category(present) is None


@pytest.mark.parametrize("present", [set(), {F.VISUALIZATION, F.SENSORS}])
def test_nothing_is_near_an_app_without_any_of_the_functions(present):
    assert nearest_category(present) is None


def test_an_app_of_a_category_has_no_nearest():
    assert app_profile(graph(*SLAM_NODES, links=SLAM_LINKS)).nearest is None
    near = app_profile(graph(*SLAM_NODES[:2], links=SLAM_LINKS[:2])).nearest
    assert near.categories == ("SLAM",)
