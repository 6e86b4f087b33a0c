"""How names are spelled."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.vocabulary import (
    PRIVATE_ROOT,
    fits_open_name,
    flow_topic,
    is_bridge_client,
    lease_topic,
    matches_node,
    normalise_type,
    output_topic,
    unstamped_type,
)
from rtron.vocabulary.launch import canonical_name, resolve_name
from rtron.vocabulary.names import EMERGENCY_STOP, are_nested, snake_case

parts = st.text("ab_/~", max_size=8)


@pytest.mark.parametrize(
    ("written", "spelled"),
    [
        ("geometry_msgs/msg/Twist", "geometry_msgs/Twist"),
        ("geometry_msgs/Twist", "geometry_msgs/Twist"),
        ("msg/msg/msg", "msg/msg"),
        ("", ""),
    ],
)
def test_both_generations_spell_one_type(written, spelled):
    assert normalise_type(written) == spelled


@pytest.mark.parametrize(
    ("type", "counts_as"),
    [
        ("geometry_msgs/TwistStamped", "geometry_msgs/Twist"),
        ("geometry_msgs/msg/TwistStamped", "geometry_msgs/Twist"),
        ("geometry_msgs/Twist", "geometry_msgs/Twist"),
        ("geometry_msgs/PoseStamped", "geometry_msgs/PoseStamped"),
    ],
)
def test_only_a_velocity_loses_its_stamp(type, counts_as):
    assert unstamped_type(type) == counts_as


@pytest.mark.parametrize(
    ("node", "expected"),
    [
        ("/bridge/phone", True),
        ("/bridge/hall/phone", True),
        ("/bridge", False),
        ("/bridges/a", False),
        ("/a/bridge/b", False),
    ],
)
def test_clients_of_a_bridge_are_known_by_their_namespace(node, expected):
    assert is_bridge_client(node) == expected


def test_private_topics_stand_below_the_private_root():
    assert flow_topic("/cmd_vel", "flow1") == f"{PRIVATE_ROOT}/cmd_vel/flow1"
    assert output_topic("/robot/cmd_vel") == f"{PRIVATE_ROOT}/robot/cmd_vel/out"


@pytest.mark.parametrize(
    ("pattern", "node", "means"),
    [
        ("/rviz", "/rviz", True),
        ("/rviz_*", "/rviz_17_42", True),
        ("/rviz_*", "/rviz", False),
        ("/rviz", "/rviz_17", False),
        ("/*", "/a/b", True),
        ("/[x]", "/[x]", True),
    ],
)
def test_a_pattern_means_the_nodes_that_it_fits(pattern, node, means):
    assert matches_node(pattern, node) is means


@pytest.mark.parametrize(
    ("name", "node", "resolved"),
    [
        ("/scan", "/ns/node", "/scan"),
        ("scan", "/ns/node", "/ns/scan"),
        ("scan", "/node", "/scan"),
        ("~scan", "/ns/node", "/ns/node/scan"),
        ("a//b/", "/node", "/a/b"),
    ],
)
def test_a_name_resolves_at_its_node(name, node, resolved):
    assert resolve_name(name, node) == resolved


@given(parts)
def test_a_canonical_name_stays_what_it_is(name):
    once = canonical_name(name)
    assert canonical_name(once) == once
    assert "//" not in once


@pytest.mark.parametrize(
    ("name", "open_name", "fits"),
    [
        ("/a/image", "/{side}/image", True),
        ("/a/b/image", "/{?}/image", True),
        ("/a/scan", "/{side}/image", False),
        ("/image", "/image", False),
        ("/a_1/x_2", "/a_{n}/x_{m}", True),
        ("/a", "/{", True),
    ],
)
def test_a_name_may_be_one_that_is_known_in_part(name, open_name, fits):
    assert fits_open_name(name, ["/other", open_name]) is fits


@pytest.mark.parametrize(
    ("one", "other", "nested"),
    [
        ("/a", "/a", True),
        ("/a", "/a/b", True),
        ("/a/b", "", True),
        ("/a", "/ab", False),
        ("/a", "/b", False),
    ],
)
def test_namespaces_are_nested_either_way(one, other, nested):
    assert are_nested(one, other) is are_nested(other, one) is nested


def test_the_topics_of_a_lease_are_private():
    assert lease_topic("base", "request") == f"{PRIVATE_ROOT}/leases/base/request"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("chassisCommand", "chassis_command"),
        ("/robot/wheelVelMeasured", "/robot/wheel_vel_measured"),
        ("cmd_vel", "cmd_vel"),
        ("", ""),
    ],
)
def test_words_that_stand_apart(name, expected):
    assert snake_case(name) == expected


@pytest.mark.parametrize(
    "name",
    ["/e_stop", "/robot/eStop", "estopped", "/hard_kill", "/safety/emergency", "/remote_stop"],
)
def test_what_stops_a_robot(name):
    assert EMERGENCY_STOP.search(snake_case(name))


@pytest.mark.parametrize("name", ["/pose_stop", "/bus_stop", "/killer", "/halted", "/stop_sign"])
def test_what_is_no_emergency_stop(name):
    assert not EMERGENCY_STOP.search(snake_case(name))
