"""What is installed of ROS 2 is read as rclpy writes it, and refused where rclpy refuses it."""

import os
import random
import struct
import sysconfig
from functools import cache
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rclpy._rclpy_pybind11 import RMWError
from rclpy.serialization import deserialize_message
from ros2_samples import made, round_trip

from example_budget import examples
from rtron.errors import SourceError, WireError
from rtron.messages import parse_definition
from rtron.messages.ros2.cdr_validator import cdr_validator
from rtron.wire.ros2.endpoints import publishers_of
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import Ros2Session

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]

WIDE = "test_msgs/msg/WStrings"


def installed(kind):
    """Return the types that are installed, as their files are called."""
    sourced = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    prefixes = {Path(each) for each in (*sourced, sysconfig.get_path("data")) if each}
    files = {file for prefix in prefixes for file in prefix.glob(f"share/*/{kind}/*.{kind}")}
    return sorted(f"{file.parts[-3]}/{kind}/{file.stem}" for file in files)


MESSAGES = [type for type in installed("msg") if type != WIDE]


@cache
def checked(type):
    """Return a type's class and what says whether bytes are whole."""
    found = find_interface(type)
    return found.cls, cdr_validator(parse_definition(found.name, found.definition))


@pytest.mark.parametrize("type", MESSAGES)
def test_every_installed_type(type):
    """A message ends where rclpy ends it: it reads the same, and cannot do with a byte less."""
    cls, look = checked(type)
    pick = random.Random(type).choice
    for _ in range(5):
        message = made(cls, pick)
        data = round_trip(message, look)
        assert deserialize_message(data, cls) == message
        with pytest.raises(RMWError):
            deserialize_message(data[:-1], cls)


@settings(max_examples=examples(400), suppress_health_check=list(HealthCheck), deadline=None)
@given(type=st.sampled_from(MESSAGES), seed=st.integers(0, 2**32), data=st.data())
def test_what_rclpy_refuses_is_not_whole(type, seed, data):
    cls, look = checked(type)
    message = bytearray(round_trip(made(cls, random.Random(seed).choice), look))
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, max(len(message) - 1, 0)))
        change = data.draw(st.sampled_from(["bit", "count", "cut", "put"]))
        if change == "bit" and message:
            message[at] ^= 1 << data.draw(st.integers(0, 7))
        elif change == "count" and at > 3:
            number = data.draw(st.sampled_from([0, 1, 200, 1 << 16, 1 << 31, (1 << 32) - 1]))
            message[at & ~3 : (at & ~3) + 4] = struct.pack("<I", number)
        elif change == "cut":
            del message[at:]
        else:
            message[at:at] = data.draw(st.binary(max_size=20))
    try:
        look(bytes(message))
    except WireError:
        return
    deserialize_message(bytes(message), cls)


def test_services_are_installed_too():
    found = find_interface("std_srvs/srv/SetBool")
    assert (found.name, found.cls.__name__) == ("std_srvs/SetBool_Request", "SetBool")
    assert parse_definition(found.name, found.definition).find("data").type == "bool"
    for type in installed("srv"):
        assert find_interface(type).type == type


def test_an_action_s_definition_is_its_goal_s():
    found = find_interface("test_msgs/action/Fibonacci")
    definition = parse_definition(found.name, found.definition)
    assert found.name == "test_msgs/Fibonacci_Goal"
    assert [each.name for each in definition.fields] == ["order"]
    nested = find_interface("test_msgs/action/NestedMessage")
    assert "test_msgs/Builtins" in parse_definition(nested.name, nested.definition).nested


@pytest.mark.parametrize("spelling", ["std_msgs/String", "std_msgs/msg/String"])
def test_either_spelling(spelling):
    found = find_interface(spelling)
    assert (found.type, found.name) == ("std_msgs/msg/String", "std_msgs/String")
    assert found.cls.__name__ == "String"
    assert found.md5sum == "992ce8a1687cec8c8bd883ec73ca41d1"


def test_wide_strings_are_refused():
    with pytest.raises(SourceError, match="wstring is no type"):
        find_interface(WIDE)


@pytest.mark.parametrize(
    "type", ["geometry_msgs/msg/Twist", "sensor_msgs/msg/PointCloud2", "std_msgs/msg/Empty"]
)
def test_the_hash_is_the_domain_s(type, ros2, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    session = Ros2Session(domain=ros2.domain)
    try:
        node = session.node("/one")
        node.create_publisher(find_interface(type).cls, "/topic", 1)
        (found,) = publishers_of(node, "/topic")
        assert find_interface(type).type_hash == found.type_hash != ""
    finally:
        session.close()
