"""Stamps: nanoseconds of the header that a message begins with."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from message_samples import ENCODINGS, POSE, encode, header, make, pose

from rtron.errors import WireError
from rtron.messages import DefinitionRegistry, Encoding, parse_definition, stamp_reader

DEFINITIONS = {Encoding.ROS1: DefinitionRegistry(), Encoding.CDR: DefinitionRegistry(ros=2)}


@given(
    encoding=st.sampled_from(ENCODINGS),
    seconds=st.integers(0, 2**31 - 1),
    nanoseconds=st.integers(0, 999_999_999),
)
def test_stamp(encoding, seconds, nanoseconds):
    made = make(encoding, POSE, header(encoding, "map", seconds, nanoseconds), pose(encoding))
    read = stamp_reader(DEFINITIONS[encoding].find(POSE), encoding)
    assert read(encode(encoding, POSE, made)) == seconds * 1_000_000_000 + nanoseconds


def test_signs():
    """ROS 1 counts seconds to 2106, ROS 2 from 1901."""
    ros1 = stamp_reader(DEFINITIONS[Encoding.ROS1].find(POSE), Encoding.ROS1)
    ros2 = stamp_reader(DEFINITIONS[Encoding.CDR].find(POSE), Encoding.CDR)
    assert ros1(struct.pack("<IIII", 12, 0, 2**32 - 1, 0)) == (2**32 - 1) * 10**9
    assert ros2(b"\0\1\0\0" + struct.pack("<iI", -1, 5)) == -(10**9) + 5


@pytest.mark.parametrize("type", ["geometry_msgs/Twist", "std_msgs/Empty", "std_msgs/Header"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_no_header_in_front(type, encoding):
    assert stamp_reader(DEFINITIONS[encoding].find(type), encoding) is None


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Header header\n====\nMSG: std_msgs/Header\nuint32 seq\ntime stamp", True),
        ("Header h\n====\nMSG: std_msgs/Header\ntime stamp\nstring frame_id", True),
        ("Header header\n====\nMSG: std_msgs/Header\nstring frame_id\ntime stamp", False),
        ("Header header\n====\nMSG: std_msgs/Header\nuint32 seq\nduration stamp", False),
        ("Header header\n====\nMSG: std_msgs/Header\ntime[] stamp", False),
        ("Header header\n====\nMSG: std_msgs/Header\n", False),
        ("Header[] header\n====\nMSG: std_msgs/Header\ntime stamp", False),
        ("int8 a\nHeader header\n====\nMSG: std_msgs/Header\ntime stamp", False),
    ],
)
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_shapes_of_headers(text, expected, encoding):
    assert (stamp_reader(parse_definition("a/B", text), encoding) is not None) is expected


@given(encoding=st.sampled_from(ENCODINGS), message=st.binary(max_size=24))
def test_fuzz_stamp(encoding, message):
    read = stamp_reader(DEFINITIONS[encoding].find(POSE), encoding)
    try:
        assert isinstance(read(message), int)
    except WireError:
        return


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_too_short(encoding):
    read = stamp_reader(DEFINITIONS[encoding].find(POSE), encoding)
    length = 12 if encoding is Encoding.ROS1 else 8
    for size in (0, length - 1):
        front = b"\0\1\0\0" if encoding is Encoding.CDR else struct.pack("<I", size)
        with pytest.raises(WireError, match="ends before its stamp"):
            read(front + bytes(size))
