"""Velocities: read as rosbags wrote them; written back, no limit breaks, nothing else changes."""

import math
import struct

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from message_samples import ENCODINGS, ROS2, encode, header, make

from example_budget import examples
from rtron.errors import WireError
from rtron.messages import (
    VELOCITY_TYPES,
    DefinitionRegistry,
    Encoding,
    parse_definition,
    velocity_codec,
)
from rtron.vocabulary import Velocity

DEFINITIONS = {Encoding.ROS1: DefinitionRegistry(), Encoding.CDR: DefinitionRegistry(ros=2)}
TWIST, STAMPED = "geometry_msgs/Twist", "geometry_msgs/TwistStamped"
DRIVE, DRIVE_STAMPED = "ackermann_msgs/AckermannDrive", "ackermann_msgs/AckermannDriveStamped"

doubles = st.one_of(
    st.floats(),
    st.sampled_from([0.0, -0.0, 5e-324, -5e-324, 2.2e-308, 1e308, -1.7e308, math.inf, math.nan]),
    st.floats(-1.0, 1.0),
)
singles = st.one_of(st.floats(width=32), st.floats(-1.0, 1.0, width=32))
limits = st.one_of(
    st.floats(0.0, 2.0),
    st.sampled_from([0.0, 5e-324, 1e-320, 2.3e-308, 1e-45, 1e-38, 0.22, 1.0, 3.5e38, 1e308]),
)
encodings = st.sampled_from(ENCODINGS)
frames = st.sampled_from(["", "a", "ab", "abc", "base_link"])


def codec(encoding, type):
    return velocity_codec(DEFINITIONS[encoding].find(type), encoding)


def vector(encoding, values):
    return make(encoding, "geometry_msgs/Vector3", *values)


def twist(encoding, values):
    return make(encoding, TWIST, vector(encoding, values[:3]), vector(encoding, values[3:]))


def twist_message(encoding, values):
    return encode(encoding, TWIST, twist(encoding, values))


def stamped_message(encoding, values, frame="map"):
    made = make(encoding, STAMPED, header(encoding, frame), twist(encoding, values))
    return encode(encoding, STAMPED, made)


def drive_message(encoding, values, frame=None):
    """Return an AckermannDrive, behind a header if `frame` is given; rosbags does not know it."""
    body = struct.pack("<5f", *values)
    if frame is None:
        front = b"\0\1\0\0" if encoding is Encoding.CDR else struct.pack("<I", len(body))
        return front + body
    head = encode(encoding, "std_msgs/Header", header(encoding, frame))
    if encoding is Encoding.CDR:
        return head + b"\0" * (-len(head) % 4) + body
    return struct.pack("<I", len(head) - 4 + len(body)) + head[4:] + body


def bits(values):
    return struct.pack(f"<{len(values)}d", *values)


SIX = st.lists(doubles, min_size=6, max_size=6)


@given(encoding=encodings, values=SIX, frame=frames)
def test_twists_are_read(encoding, values, frame):
    for type, message in (
        (TWIST, twist_message(encoding, values)),
        (STAMPED, stamped_message(encoding, values, frame)),
    ):
        found = codec(encoding, type).decode(message)
        assert bits(found.linear + found.angular) == bits(values)
        assert len(found.linear) == 3
        assert not codec(encoding, type).is_limit


@given(encoding=encodings, values=SIX, frame=frames)
def test_whether_all_are_numbers_is_what_reading_them_tells(encoding, values, frame):
    for type, message in (
        (TWIST, twist_message(encoding, values)),
        (STAMPED, stamped_message(encoding, values, frame)),
    ):
        found = codec(encoding, type).decode(message)
        assert codec(encoding, type).is_finite(message) is found.is_finite
    assert not codec(encoding, TWIST).is_finite(twist_message(encoding, [math.inf, -math.inf] * 3))
    assert codec(encoding, TWIST).is_finite(twist_message(encoding, [1.7e308] * 6))


@given(encoding=encodings, values=SIX, other=SIX, frame=frames)
def test_twists_are_written(encoding, values, other, frame):
    velocity = Velocity(tuple(other[:3]), tuple(other[3:]))
    for type, write in (
        (TWIST, lambda six: twist_message(encoding, six)),
        (STAMPED, lambda six: stamped_message(encoding, six, frame)),
    ):
        assert codec(encoding, type).encode(write(values), velocity) == write(other)


@given(encoding=encodings, values=st.lists(singles, min_size=5, max_size=5), frame=frames)
def test_drives_are_read(encoding, values, frame):
    for type, message in (
        (DRIVE, drive_message(encoding, values)),
        (DRIVE_STAMPED, drive_message(encoding, values, frame)),
    ):
        found = codec(encoding, type).decode(message)
        assert found.angular == ()
        if all(map(math.isfinite, values)):
            assert bits(found.linear) == bits([values[2]])
        else:
            assert not found.is_finite


@given(
    encoding=encodings,
    values=st.lists(singles, min_size=5, max_size=5),
    speed=singles,
    frame=st.none() | frames,
)
def test_drives_are_written(encoding, values, speed, frame):
    written = [*values[:2], speed, *values[3:]]
    type = DRIVE if frame is None else DRIVE_STAMPED
    found = codec(encoding, type).encode(drive_message(encoding, values, frame), Velocity((speed,)))
    assert found == drive_message(encoding, written, frame)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("index", range(5))
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_no_other_float_of_a_drive_may_be_no_number(encoding, index, bad):
    values = [0.1] * 5
    assert codec(encoding, DRIVE).decode(drive_message(encoding, values)).is_finite
    values[index] = bad
    assert not codec(encoding, DRIVE).decode(drive_message(encoding, values)).is_finite


@given(encoding=encodings, value=doubles, other=doubles)
def test_limits_of_64_bits(encoding, value, other):
    type = "std_msgs/Float64"
    message, changed = (
        encode(encoding, type, make(encoding, type, each)) for each in (value, other)
    )
    found = codec(encoding, type)
    assert found.is_limit
    assert bits(found.decode(message).linear) == bits([value])
    assert found.encode(message, Velocity((other,))) == changed


@given(encoding=encodings, value=doubles)
def test_rounding_goes_toward_zero(encoding, value):
    type = "std_msgs/Float32"
    found = codec(encoding, type)
    message = encode(encoding, type, make(encoding, type, 0.0))
    (written,) = found.decode(found.encode(message, Velocity((value,)))).linear
    if not math.isfinite(value):
        assert repr(written) == repr(value)
        return
    assert abs(written) <= abs(value)
    assert math.copysign(1, written) == math.copysign(1, value)
    (up,) = struct.unpack(
        "<f", struct.pack("<I", struct.unpack("<I", struct.pack("<f", abs(written)))[0] + 1)
    )
    assert up > abs(value) or math.isinf(up)


@settings(max_examples=examples(500))
@given(encoding=encodings, values=SIX, limit=limits)
def test_no_twist_is_above_its_limit(encoding, values, limit):
    found = codec(encoding, TWIST)
    message = twist_message(encoding, values)
    velocity = found.decode(message)
    assume(velocity.is_finite)
    written = found.decode(found.encode(message, velocity.at_most(limit)))
    assert written.speed <= limit
    if velocity.speed <= limit:
        assert bits(written.linear + written.angular) == bits(values)


@given(
    encoding=encodings,
    forward=st.floats(-10, 10).filter(lambda x: abs(x) > 1e-6),
    turn=st.floats(-10, 10),
    limit=st.floats(1e-6, 20),
)
def test_curvature_stays(encoding, forward, turn, limit):
    found = codec(encoding, TWIST)
    message = twist_message(encoding, [forward, 0.0, 0.0, 0.0, 0.0, turn])
    written = found.decode(found.encode(message, found.decode(message).at_most(limit)))
    assert written.angular[2] / written.linear[0] == pytest.approx(turn / forward, rel=1e-9)


@settings(max_examples=examples(500))
@given(encoding=encodings, values=st.lists(singles, min_size=5, max_size=5), limit=limits)
def test_no_drive_is_above_its_limit(encoding, values, limit):
    found = codec(encoding, DRIVE)
    message = drive_message(encoding, values)
    velocity = found.decode(message)
    assume(velocity.is_finite)
    written = found.encode(message, velocity.at_most(limit))
    assert found.decode(written).speed <= limit
    assert written[:12] + written[16:] == message[:12] + message[16:]


def test_a_twist_of_32_bits():
    """Another definition of the type, as its publisher gives it; no limit breaks there either."""
    text = "V linear\nV angular\n====\nMSG: geometry_msgs/V\nfloat32 x\nfloat32 y\nfloat32 z\n"
    found = velocity_codec(parse_definition(TWIST, text), Encoding.ROS1)
    message = struct.pack("<I6f", 24, 0.3, 0.1, 0.7, 0.0, 0.0, 1.0)
    for limit in (0.7, 0.1, 1e-20, 1e-45, 0.0):
        velocity = found.decode(message).at_most(limit)
        assert found.decode(found.encode(message, velocity)).speed <= limit


VECTORS = "Vector3 linear\nVector3 angular\n====\nMSG: geometry_msgs/Vector3\n"


@pytest.mark.parametrize(
    ("type", "text"),
    [
        ("geometry_msgs/Pose", "float64 x"),
        ("std_msgs/Float64", "int64 data"),
        ("std_msgs/Float64", "string data"),
        ("std_msgs/Float64", "float64[] data"),
        ("std_msgs/Float64", "float64[1] data"),
        ("std_msgs/Float64", "float64 value"),
        ("std_msgs/Float64", "float64 data\nfloat64 more"),
        ("std_msgs/Float64", ""),
        (TWIST, VECTORS + "float64 x\nfloat64 y"),
        (TWIST, VECTORS + "float64 y\nfloat64 x\nfloat64 z"),
        (TWIST, VECTORS + "float64 x\nfloat64 y\nfloat32 z"),
        (TWIST, VECTORS + "int64 x\nint64 y\nint64 z"),
        (TWIST, VECTORS + "float64[] x\nfloat64 y\nfloat64 z"),
        (TWIST, "float64 x"),
        (STAMPED, "float64 twist"),
        (STAMPED, "float64 x"),
        (STAMPED, "Twist[] twist\n====\nMSG: geometry_msgs/Twist\n" + VECTORS + "float64 x"),
        (DRIVE, "float32 speed"),
    ],
)
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_no_velocity(type, text, encoding):
    assert velocity_codec(parse_definition(type, text), encoding) is None


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("type", sorted(VELOCITY_TYPES))
def test_every_velocity_type_has_a_codec(type, encoding):
    found = codec(encoding, type)
    assert found is not None
    assert found.is_limit == type.startswith("std_msgs/Float")


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_other_length_is_refused(encoding):
    for type, message in (
        (TWIST, twist_message(encoding, [1.0] * 6)),
        (STAMPED, stamped_message(encoding, [1.0] * 6)),
        (DRIVE_STAMPED, drive_message(encoding, [1.0] * 5, "map")),
    ):
        found = codec(encoding, type)
        velocity = found.decode(message)
        for wrong in [*(message[:n] for n in range(len(message))), message + b"\0" * 4]:
            for call in (found.decode, lambda each: found.encode(each, velocity)):  # noqa: B023
                with pytest.raises(WireError):
                    call(wrong)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("type", sorted(VELOCITY_TYPES))
def test_rest_is_a_message_of_zeros(type, encoding):
    found = codec(encoding, type)
    assert not any(found.zero_message[4:])
    assert not found.decode(found.zero_message).is_moving
    length = {TWIST: 48, DRIVE: 20, "std_msgs/Float64": 8, "std_msgs/Float32": 4}.get(type)
    head = 16 if encoding is Encoding.ROS1 else 12
    stamped = {STAMPED: 48 + head + (head == 12) * 4, DRIVE_STAMPED: 20 + head}.get(type)
    assert len(found.zero_message) == 4 + (length or stamped)


STRANGE = "Twist twist\n{} more\n===\nMSG: geometry_msgs/Twist\n" + VECTORS + "float64 x\n"


@pytest.mark.parametrize(
    ("more", "size"),
    [
        ("uint8[1000]", 1048),
        ("string", 52),
        ("Deep[100]", 48 + 500),
        ("float64[8000]", 64048),
        ("float64[9000]", None),
        ("Deep[20000]", None),
    ],
)
def test_strange_definitions_have_a_rest_or_no_codec(more, size):
    """A stranger may put anything beside the velocity; no message of zeros is over 64 KiB."""
    text = STRANGE.format(more) + "float64 y\nfloat64 z\n===\nMSG: geometry_msgs/Deep\n"
    definition = parse_definition(STAMPED, text + "uint8 a\nstring b\n")
    found = velocity_codec(definition, Encoding.ROS1)
    if size is None:
        assert found is None
    else:
        assert len(found.zero_message) == size + 4
        assert not found.decode(found.zero_message).is_moving


def test_padding_of_cdr_stays():
    message = twist_message(Encoding.CDR, [1.0] * 6) + b"\0\0\0"
    found = codec(Encoding.CDR, TWIST)
    assert found.encode(message, found.decode(message)) == message
    assert found.encode(b"\0\1\0\3" + message[4:], found.decode(message))[:4] == b"\0\1\0\3"


@given(
    encoding=encodings, type=st.sampled_from(sorted(VELOCITY_TYPES)), body=st.binary(max_size=90)
)
def test_fuzz_velocity(encoding, type, body):
    front = b"\0\1\0\0" if encoding is Encoding.CDR else struct.pack("<I", len(body))
    found = codec(encoding, type)
    try:
        velocity = found.decode(front + body)
    except WireError:
        return
    if velocity.is_finite:
        assert len(found.encode(front + body, velocity.at_most(0.1))) == len(body) + 4


def test_both_spellings():
    text = ROS2.generate_msgdef("geometry_msgs/msg/Twist", ros_version=2)[0]
    assert velocity_codec(parse_definition("geometry_msgs/msg/Twist", text), Encoding.CDR)
