"""Messages as JSON: what rosbags writes is the oracle, and what does not fit is refused by name."""

import base64
import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from message_samples import ENCODINGS, Generator, encode, header, long_name, make, point, store

from rtron.errors import WireError
from rtron.messages import DefinitionRegistry, Encoding, parse_definition
from rtron.messages.common.json_decoder import decode_json, decode_response
from rtron.messages.common.json_encoder import encode_json

REGISTRIES = {Encoding.ROS1: DefinitionRegistry(ros=1), Encoding.CDR: DefinitionRegistry(ros=2)}
WALL = 1_700_000_000_123_456_789
LARGE = 1 << 20
TYPES = (
    "geometry_msgs/Twist",
    "geometry_msgs/PoseWithCovarianceStamped",
    "nav_msgs/Odometry",
    "nav_msgs/Path",
    "sensor_msgs/Image",
    "sensor_msgs/LaserScan",
    "sensor_msgs/JointState",
    "sensor_msgs/PointCloud2",
    "std_msgs/ByteMultiArray",
    "std_msgs/UInt64",
    "visualization_msgs/MarkerArray",
    "trajectory_msgs/JointTrajectory",
    "diagnostic_msgs/DiagnosticArray",
)
TWIST = "geometry_msgs/Twist"
EVERY = parse_definition(
    "t/Every",
    "bool b\nint8 i\nuint8[] bytes\nchar[3] three\nint64 l\nuint16[<=2] few\nfloat32 f\n"
    "float64[] d\n"
    "string s\nstring<=3 short\ntime at\nduration for\nt/Part[] parts\n"
    "================\nMSG: t/Part\nstring name\nint32[2] pair\n",
)


def written(value, encoding=Encoding.CDR, definition=EVERY, limit=LARGE):
    return encode_json(definition, encoding, value, WALL, limit)[0]


def back(value, encoding=Encoding.CDR, definition=EVERY):
    return decode_json(definition, encoding, written(value, encoding, definition))


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("type", TYPES)
@given(seed=st.integers(0, 10_000))
def test_what_rosbags_writes_is_read_and_written_again(encoding, type, seed):
    made, _ = Generator(encoding, seed).message(long_name(type))
    message = encode(encoding, type, made)
    definition = REGISTRIES[encoding].find(type)
    value = decode_json(definition, encoding, message)
    text = json.dumps(value, allow_nan=False)
    if "null" not in text and (encoding is Encoding.ROS1 or "\\u0000" not in text):
        again, missing = encode_json(definition, encoding, json.loads(text), WALL, LARGE)
        padding = -len(again) % 4 if encoding is Encoding.CDR else 0
        assert (again, missing) in ((message, ()), (message[: len(again)], ()))
        assert len(message) - len(again) <= padding


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_twist_of_rosbags(encoding):
    vector = make(encoding, "geometry_msgs/Vector3", 0.5, 0.0, -1.0)
    expected = encode(encoding, TWIST, make(encoding, TWIST, vector, vector))
    part = {"x": 0.5, "y": 0, "z": -1}
    definition = REGISTRIES[encoding].find(TWIST)
    value = {"linear": part, "angular": part}
    assert encode_json(definition, encoding, value, WALL, LARGE) == (expected, ())
    assert decode_json(definition, encoding, expected) == value


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_header_that_is_left_out_has_the_present_time(encoding):
    definition = REGISTRIES[encoding].find("geometry_msgs/PointStamped")
    message, missing = encode_json(definition, encoding, {}, WALL, LARGE)
    assert {"header", "header.stamp", "point"} <= set(missing)
    stamp = decode_json(definition, encoding, message)["header"]["stamp"]
    assert list(stamp.values()) == [1_700_000_000, 123_456_789]
    assert list(stamp) == (["secs", "nsecs"] if encoding is Encoding.ROS1 else ["sec", "nanosec"])


def test_no_other_time_that_is_left_out_is_the_present_one():
    assert back({})["at"] == {"sec": 0, "nanosec": 0}


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_the_fields_of_a_stamped_point(encoding):
    made = make(encoding, "geometry_msgs/PointStamped", header(encoding), point(encoding))
    definition = REGISTRIES[encoding].find("geometry_msgs/PointStamped")
    value = decode_json(definition, encoding, encode(encoding, "geometry_msgs/PointStamped", made))
    assert value["header"]["frame_id"] == "map"
    assert value["point"] == {"x": 1.0, "y": 2.0, "z": 3.0}
    assert store(encoding)


def test_bytes_are_base64_in_both_directions_or_a_list():
    assert back({"bytes": base64.b64encode(b"abc").decode()})["bytes"] == "YWJj"
    assert back({"bytes": [97, 98, 99]})["bytes"] == "YWJj"


def test_nan_and_inf_are_null_in_json():
    definition = REGISTRIES[Encoding.ROS1].find("std_msgs/Float64")
    nan = encode(
        Encoding.ROS1, "std_msgs/Float64", make(Encoding.ROS1, "std_msgs/Float64", math.nan)
    )
    assert decode_json(definition, Encoding.ROS1, nan) == {"data": None}


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ({"turbo": 1}, "t/Every has no field 'turbo'"),
        ([], "t/Every is an object, not a list"),
        ({"b": 1}, "b is true or false, not '1'"),
        ({"i": True}, "i is a whole number"),
        ({"i": 1.0}, "i is a whole number"),
        ({"i": 128}, "i: the number is out of the range"),
        ({"i": None}, "i is a whole number, not null"),
        ({"l": 1 << 63}, "l: the number is out of the range"),
        ({"f": math.nan}, "f is NaN or Inf"),
        ({"f": math.inf}, "f is NaN or Inf"),
        ({"f": "1"}, "f is a number, not '1'"),
        ({"f": None}, "f is a number, not null"),
        ({"f": True}, "f is a number"),
        ({"f": 1e39}, "f: the number is out of the range"),
        ({"f": 10**400}, "f: the number is out of the range"),
        ({"d": [0.0, -math.inf]}, r"d\[1\] is NaN or Inf"),
        ({"d": [10**400]}, "d: the number is out of the range"),
        ({"d": {}}, "d is a list, not an object"),
        ({"bytes": "a?"}, "bytes is neither a list nor base64"),
        ({"bytes": [256]}, "bytes: the number is out of the range"),
        ({"three": [1, 2]}, "three has 3 elements, not 2"),
        ({"three": "YWI="}, "three has 3 elements, not 2"),
        ({"few": [1, 2, 3]}, "few has at most 2 elements, not 3"),
        ({"s": 5}, "s is a string, not '5'"),
        ({"s": "a\0b"}, "s has the character NUL"),
        ({"s": "\ud800"}, "s is no text"),
        ({"short": "äää"}, "short has at most 3 bytes, not 6"),
        ({"at": 3}, "at is an object with sec and nanosec"),
        ({"at": {"secs": 1}}, "at has sec and nanosec, not 'secs'"),
        ({"at": {"sec": 1, "nanosec": 1_000_000_000}}, "at.nanosec is no part of a second"),
        ({"at": {"sec": 1 << 31}}, "at: the number is out of the range"),
        ({"at": {"sec": None}}, "at.sec is a whole number, not null"),
        ({"parts": [{}, 4]}, r"parts\[1\] is an object, not '4'"),
        ({"parts": [{"pair": [1]}]}, r"parts\[0\].pair has 2 elements, not 1"),
        ({"parts": [{"pair": [1, "x"]}]}, r"parts\[0\].pair\[1\] is a whole number"),
    ],
)
def test_what_does_not_fit_is_refused_with_its_place(value, reason):
    with pytest.raises(WireError, match=reason):
        written(value)


def test_a_reason_is_short_and_cannot_steer_a_terminal():
    with pytest.raises(WireError) as raised:
        written({"\x1b[2J" + "x" * 10_000: 1})
    assert len(str(raised.value)) < 100
    assert str(raised.value).isprintable()


def test_what_is_left_out_takes_no_room_in_json_but_is_bounded():
    wide = parse_definition("t/Wide", "t/Row[] rows\n===\nMSG: t/Row\nfloat64[1000] cells\n")
    with pytest.raises(WireError, match="more than 100000 bytes"):
        written({"rows": [{}] * 100_000}, definition=wide, limit=100_000)
    assert len(written({"rows": [{}]}, definition=wide, limit=100_000)) > 8000


def test_few_of_the_missing_names_are_kept():
    _, missing = encode_json(EVERY, Encoding.ROS1, {"parts": [{}] * 1000}, WALL, LARGE)
    assert len(missing) == 20


@pytest.mark.parametrize("encoding", ENCODINGS)
@given(cut=st.integers(0, 200), flip=st.integers(0, 200), value=st.integers(0, 255))
def test_a_damaged_message_is_an_error_or_another_message(encoding, cut, flip, value):
    message = bytearray(written({"s": "abc", "d": [1.0, 2.0], "parts": [{"name": "x"}]}, encoding))
    message[flip % len(message)] = value
    try:
        json.dumps(decode_json(EVERY, encoding, bytes(message[: len(message) - cut])))
    except WireError:
        return


def test_a_count_without_its_elements_makes_no_list():
    message = Encoding.ROS1.prefix(4) + (1 << 31).to_bytes(4, "little")
    definition = parse_definition("t/Many", "float64[] d\n")
    with pytest.raises(WireError, match="elements are announced"):
        decode_json(definition, Encoding.ROS1, message)


def test_bytes_behind_a_response_count_only_where_they_are_the_sender_s():
    number = parse_definition("t/Number", "int32 n\n")
    longer = written({"n": 5}, Encoding.CDR, number) + b"12345678"
    assert decode_response(number, Encoding.CDR, longer) == {"n": 5}
    for encoding, message in (
        (Encoding.ROS1, Encoding.ROS1.prefix(12) + bytes(12)),
        (Encoding.CDR, longer[:6]),
    ):
        with pytest.raises(WireError):
            decode_response(number, encoding, message)
    with pytest.raises(WireError, match="8 bytes follow"):
        decode_json(number, Encoding.CDR, longer)


def test_a_message_without_fields():
    empty = parse_definition("t/Empty", "")
    assert written({}, Encoding.ROS1, empty) == bytes(4)
    assert written({}, Encoding.CDR, empty) == b"\0\1\0\0\0"
    assert back({}, Encoding.CDR, empty) == {}
