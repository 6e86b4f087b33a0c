"""Poses as messages of either ROS tell them, written by rosbags."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from rtron.errors import WireError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.pose import POSE_TYPES, pose_reader

STORES = {
    Encoding.ROS1: (get_typestore(Stores.ROS1_NOETIC), 1),
    Encoding.CDR: (get_typestore(Stores.ROS2_JAZZY), 2),
}
TYPES = sorted(POSE_TYPES)
number = st.floats(-1e6, 1e6)


def reader_of(type, encoding):
    store, ros = STORES[encoding]
    text, _ = store.generate_msgdef(type.replace("/", "/msg/"), ros_version=ros)
    return pose_reader(parse_definition(type, text), encoding)


def message(type, encoding, frame, x, y, yaw):
    import numpy as np  # noqa: PLC0415

    store, _ = STORES[encoding]
    types = store.types

    def made(name, **fields):
        return types[name.replace("/", "/msg/")](**fields)

    stamp = types["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
    seq = {"seq": 3} if encoding is Encoding.ROS1 else {}
    header = made("std_msgs/Header", stamp=stamp, frame_id=frame, **seq)
    half = yaw / 2
    turn = made("geometry_msgs/Quaternion", x=0.0, y=0.0, z=math.sin(half), w=math.cos(half))
    place = made("geometry_msgs/Point", x=x, y=y, z=0.5)
    pose = made("geometry_msgs/Pose", position=place, orientation=turn)
    more = {}
    if type != "geometry_msgs/PoseStamped":
        pose = made("geometry_msgs/PoseWithCovariance", pose=pose, covariance=np.zeros(36))
    if type == "nav_msgs/Odometry":
        zero = made("geometry_msgs/Vector3", x=0.0, y=0.0, z=0.0)
        twist = made("geometry_msgs/Twist", linear=zero, angular=zero)
        twist = made("geometry_msgs/TwistWithCovariance", twist=twist, covariance=np.zeros(36))
        more = {"child_frame_id": "base_link", "twist": twist}
    whole = made(type, header=header, pose=pose, **more)
    name = type.replace("/", "/msg/")
    if encoding is Encoding.CDR:
        return bytes(store.serialize_cdr(whole, name))
    raw = bytes(store.serialize_ros1(whole, name))
    return encoding.prefix(len(raw)) + raw


@pytest.mark.parametrize("encoding", STORES)
@pytest.mark.parametrize("type", TYPES)
@given(frame=st.sampled_from(["", "map", "odom_frame"]), x=number, y=number, yaw=st.floats(-3, 3))
def test_a_pose_is_read_as_it_was_written(type, encoding, frame, x, y, yaw):
    pose = reader_of(type, encoding)(message(type, encoding, frame, x, y, yaw))
    assert pose[:3] == (frame, x, y)
    assert pose.yaw == pytest.approx(yaw, abs=1e-9)


@pytest.mark.parametrize("encoding", STORES)
@pytest.mark.parametrize("type", TYPES)
def test_no_truncation_is_read(type, encoding):
    read, whole = reader_of(type, encoding), message(type, encoding, "map", 1.0, 2.0, 0.5)
    ends = {"geometry_msgs/PoseStamped": len(whole)}
    for size in range(ends.get(type, len(whole) - 36 * 8)):
        cut = whole[:size]
        if encoding is Encoding.ROS1 and size >= 4:
            cut = encoding.prefix(size - 4) + cut[4:]
        try:
            found = read(cut)
        except WireError:
            continue
        assert found[:3] == ("map", 1.0, 2.0)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_pose_that_is_not_of_numbers_is_none(bad):
    read = reader_of(TYPES[0], Encoding.CDR)
    with pytest.raises(WireError):
        read(message(TYPES[0], Encoding.CDR, "map", bad, 0.0, 0.0))


@pytest.mark.parametrize(
    "text",
    [
        "float64 x",
        "std_msgs/Header header\nfloat64 x\n===\nMSG: std_msgs/Header\nfloat64 y",
        (
            "std_msgs/Header header\ngeometry_msgs/Pose[] pose\n"
            "===\nMSG: std_msgs/Header\nstring frame_id\n===\nMSG: geometry_msgs/Pose\nfloat64 x"
        ),
        (
            "std_msgs/Header header\ngeometry_msgs/Pose pose\n"
            "===\nMSG: std_msgs/Header\nstring frame_id\n===\nMSG: geometry_msgs/Pose\nfloat64 x"
        ),
    ],
)
def test_what_is_not_defined_as_ros_does_is_not_read(text):
    definition = parse_definition("geometry_msgs/PoseStamped", text)
    assert pose_reader(definition, Encoding.ROS1) is None


def test_another_type_is_not_read():
    definition = parse_definition("my_msgs/Pose", "float64 x")
    assert pose_reader(definition, Encoding.ROS1) is None
