"""Every field of every standard type is read as rosbags wrote it, in either encoding."""

import math
import struct
from contextlib import suppress

import pytest
from google.protobuf.message_factory import GetMessageClass
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from message_samples import ENCODINGS, ROS1, ROS2, Generator, encode, header, pose_stamped

from example_budget import examples
from rtron.errors import WireError
from rtron.messages import DefinitionRegistry, Encoding, parse_definition
from rtron.messages.expressions.protobuf_types import descriptor_pool, protobuf_name
from rtron.messages.expressions.protobuf_wire import transcoder, varint

DEFINITIONS = {Encoding.ROS1: DefinitionRegistry(), Encoding.CDR: DefinitionRegistry(ros=2)}
KINDS = [(Encoding.ROS1, type) for type in sorted(ROS1.fielddefs)]
KINDS += [(Encoding.CDR, type) for type in sorted(ROS2.fielddefs)]
DUMMY = "structure_needs_at_least_one_member"


def read(definition, encoding, message, wanted=None):
    """Return the fields of a message as protobuf reads them."""
    names = [each.name for each in definition.fields] if wanted is None else wanted
    found = descriptor_pool(definition).FindMessageTypeByName(protobuf_name(definition.type))
    return GetMessageClass(found).FromString(transcoder(definition, encoding, names)(message))


def same(value, worth):
    """Compare a value that protobuf read with what it was made from."""
    if isinstance(worth, dict):
        return all(same(getattr(value, key), each) for key, each in worth.items() if key != DUMMY)
    if isinstance(worth, list):
        return len(value) == len(worth) and all(map(same, value, worth))
    if isinstance(worth, float):
        return struct.pack("<d", value) == struct.pack("<d", worth)
    return value == worth and type(value) is type(worth)


@pytest.mark.parametrize(("encoding", "type"), KINDS)
def test_round_trip(encoding, type):
    definition = DEFINITIONS[encoding].find(type)
    for seed in range(5):
        made, worth = Generator(encoding, seed).message(type)
        message = encode(encoding, type.replace("/msg/", "/"), made)
        assert same(read(definition, encoding, message), worth)


@settings(max_examples=examples(300), suppress_health_check=list(HealthCheck))
@given(kind=st.sampled_from(KINDS), seed=st.integers(0, 2**32), data=st.data())
def test_each_field_alone(kind, seed, data):
    """What is skipped moves nothing that is read."""
    encoding, type = kind
    definition = DEFINITIONS[encoding].find(type)
    made, worth = Generator(encoding, seed).message(type)
    message = encode(encoding, type.replace("/msg/", "/"), made)
    names = data.draw(st.sets(st.sampled_from([None, *(f.name for f in definition.fields)])))
    found = read(definition, encoding, message, names - {None})
    assert same(found, {name: worth[name] for name in names - {None}})
    if len(names - {None}) < len(definition.fields):
        assert {each.name for each, _ in found.ListFields()} <= names


@settings(max_examples=examples(400), suppress_health_check=list(HealthCheck))
@given(kind=st.sampled_from(KINDS), seed=st.integers(0, 2**32), data=st.data())
def test_fuzz_mutated(kind, seed, data):
    encoding, type = kind
    definition = DEFINITIONS[encoding].find(type)
    made, _ = Generator(encoding, seed).message(type)
    message = bytearray(encode(encoding, type.replace("/msg/", "/"), made))
    for _ in range(data.draw(st.integers(0, 3))):
        start = data.draw(st.integers(0, len(message)))
        end = data.draw(st.integers(start, min(len(message), start + 9)))
        message[start:end] = data.draw(
            st.binary(max_size=9) | st.sampled_from([b"\xff" * 4, b"\xff\xff\xff\x7f"])
        )
    if data.draw(st.booleans()) and encoding is Encoding.ROS1:
        message[:4] = struct.pack("<I", max(0, len(message) - 4))
    for wanted in (None, ()):
        with suppress(WireError):
            assert read(definition, encoding, bytes(message), wanted) is not None


@given(kind=st.sampled_from(KINDS), body=st.binary(max_size=100))
def test_fuzz_random(kind, body):
    encoding, type = kind
    front = b"\0\1\0\0" if encoding is Encoding.CDR else struct.pack("<I", len(body))
    try:
        assert read(DEFINITIONS[encoding].find(type), encoding, front + body) is not None
    except WireError:
        return


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_length_but_the_whole_is_refused(encoding):
    definition = DEFINITIONS[encoding].find("geometry_msgs/PoseStamped")
    message = pose_stamped(encoding)
    for wanted in (("pose",), ("header",), ()):
        decode = transcoder(definition, encoding, wanted)
        decode(message)
        for length in range(len(message)):
            with pytest.raises(WireError):
                decode(message[:length])
            if encoding is Encoding.ROS1 and length >= 4:
                with pytest.raises(WireError):
                    decode(struct.pack("<I", length - 4) + message[4:length])


@pytest.mark.parametrize(("extra", "accepted"), [(0, True), (3, True), (4, False)])
def test_bytes_behind_the_last_field_of_cdr(extra, accepted):
    """Some writers fill up to 4 bytes."""
    decode = transcoder(DEFINITIONS[Encoding.CDR].find("std_msgs/UInt8"), Encoding.CDR, ("data",))
    message = b"\0\1\0\0" + b"\5" + b"\0" * extra
    if accepted:
        assert decode(message) == decode(b"\0\1\0\0\5")
    else:
        with pytest.raises(WireError, match="4 bytes follow"):
            decode(message)


def test_bytes_behind_the_last_field_of_ros1():
    decode = transcoder(DEFINITIONS[Encoding.ROS1].find("std_msgs/UInt8"), Encoding.ROS1, ())
    with pytest.raises(WireError, match="1 bytes follow"):
        decode(b"\2\0\0\0\5\0")


@pytest.mark.parametrize("front", [b"\0\0\0\0", b"\0\3\0\0", b"\0\7\0\0", b"\1\0\0\0"])
def test_other_encapsulations(front):
    with pytest.raises(WireError, match=f"encapsulation {front[:2].hex()}"):
        Encoding.CDR.check_prefix(front + b"\5")


@pytest.mark.parametrize("message", [b"", b"\0", b"\0\1\0"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_less_than_four_bytes(encoding, message):
    with pytest.raises(WireError, match="has not even"):
        encoding.check_prefix(message)


@pytest.mark.parametrize(
    ("text", "said"),
    [(b"\xff", "UTF-8"), (b"\xed\xa0\x80", "UTF-8"), (b"a\xc3", "UTF-8"), (b"a", None)],
)
def test_utf8(text, said):
    decode = transcoder(
        DEFINITIONS[Encoding.ROS1].find("std_msgs/String"), Encoding.ROS1, ("data",)
    )
    message = struct.pack("<II", len(text) + 4, len(text)) + text
    if said:
        with pytest.raises(WireError, match=said):
            decode(message)
    else:
        assert decode(message) == b"\x0a\x01a"


@pytest.mark.parametrize(
    ("body", "expected"), [(b"\2\0\0\0a\0", b"a"), (b"\1\0\0\0\0", b""), (b"\0\0\0\0", b"")]
)
def test_strings_of_cdr(body, expected):
    decode = transcoder(DEFINITIONS[Encoding.CDR].find("std_msgs/String"), Encoding.CDR, ("data",))
    assert decode(b"\0\1\0\0" + body) == b"\x0a" + bytes([len(expected)]) + expected


def test_string_of_cdr_without_nul():
    decode = transcoder(DEFINITIONS[Encoding.CDR].find("std_msgs/String"), Encoding.CDR, ("data",))
    with pytest.raises(WireError, match="NUL"):
        decode(b"\0\1\0\0\1\0\0\0a")


@pytest.mark.parametrize(("number", "accepted"), [(2**63 - 1, True), (2**63, False)])
@pytest.mark.parametrize("type", ["uint64", "uint64[]", "uint64[1]"])
def test_integers_above_int64(type, number, accepted):
    decode = transcoder(parse_definition("a/B", f"{type} x"), Encoding.ROS1, ("x",))
    body = (struct.pack("<I", 1) if type.endswith("[]") else b"") + struct.pack("<Q", number)
    message = struct.pack("<I", len(body)) + body
    if accepted:
        decode(message)
    else:
        with pytest.raises(WireError, match="above"):
            decode(message)


@pytest.mark.parametrize("value", [1, 2, 128, 255])
@pytest.mark.parametrize("type", ["bool", "bool[1]", "bool[]"])
def test_any_byte_but_0_is_true(type, value):
    definition = parse_definition("a/B", f"{type} x")
    body = (struct.pack("<I", 1) if type.endswith("[]") else b"") + bytes([value])
    found = read(definition, Encoding.ROS1, struct.pack("<I", len(body)) + body).x
    assert found is True or list(found) == [True]


@pytest.mark.parametrize(("encoding", "value"), [(Encoding.ROS1, -1), (Encoding.CDR, 255)])
def test_byte_has_a_sign_in_ros1_only(encoding, value):
    front = b"\1\0\0\0" if encoding is Encoding.ROS1 else b"\0\1\0\0"
    assert read(parse_definition("a/B", "byte x"), encoding, front + b"\xff").x == value


def test_stamps_after_2038():
    """ROS 1 has unsigned seconds in a time."""
    definition = parse_definition("a/B", "time x")
    message = struct.pack("<III", 8, 2**32 - 1, 500_000_000)
    assert read(definition, Encoding.ROS1, message).x == 2**32 - 0.5


@pytest.mark.parametrize("count", [1, 2**16, 2**31, 2**32 - 1])
@pytest.mark.parametrize("element", ["bool", "float64", "string", "Inner", "Empty"])
def test_lengths_that_cannot_be(element, count):
    """Memory and time go with the bytes that are there, not with what is announced."""
    text = f"{element}[] x\n====\nMSG: a/Inner\nstring[] a\n====\nMSG: a/Empty\n"
    definition = parse_definition("a/B", text)
    for wanted in (("x",), ()):
        with pytest.raises(WireError, match="announced"):
            transcoder(definition, Encoding.ROS1, wanted)(struct.pack("<II", 4, count))


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_alignment_behind_strings(encoding):
    """Neighbours of every size behind strings of every length, alone and in arrays."""
    definition = parse_definition("a/B", MIXED)
    for length in range(9):
        worth = sample(length)
        message = write(encoding, definition, worth)
        assert same(read(definition, encoding, message), worth)
        for field in definition.fields:
            found = read(definition, encoding, message, (field.name,))
            assert same(found, {field.name: worth[field.name]})


MIXED = """
string s
uint8 a
float64 b
string t
uint8 c
uint16 d
float64 e
Inner[] list
Inner[2] fixed
float64[] none
uint8 f
float64[] some
time[] times
Inner last
====
MSG: a/Inner
uint8 a
float32 b
string s
int16 c
"""


def sample(length):
    inner = [{"a": n, "b": n / 2, "s": "y" * (n + length), "c": -n} for n in range(1, 6)]
    return {
        "s": "x" * length, "a": 1, "b": 2.0, "t": "z" * (length // 2), "c": 3, "d": 4, "e": 5.0,
        "list": inner[:2], "fixed": inner[2:4], "none": [], "f": 6, "some": [7.0, 8.0],
        "times": [1.5, 2.25], "last": inner[4],
    }  # fmt: skip


def write(encoding, definition, worth):
    """Write a message the slow way, as the CDR specification says it."""
    body = bytearray()
    put(encoding, body, definition, worth)
    front = b"\0\1\0\0" if encoding is Encoding.CDR else struct.pack("<I", len(body))
    return front + bytes(body)


def put(encoding, body, definition, worth):
    for field in definition.fields:
        values = worth[field.name] if field.array else [worth[field.name]]
        if field.array and field.length is None:
            put_number(encoding, body, "I", len(values))
        for value in values:
            put_value(encoding, body, field.type, definition.nested.get(field.type), value)


def put_value(encoding, body, type, nested, value):
    codes = {"uint8": "B", "int16": "h", "uint16": "H", "float32": "f", "float64": "d"}
    if nested:
        put(encoding, body, nested, value)
    elif type == "string":
        raw = value.encode() + (b"\0" if encoding is Encoding.CDR else b"")
        put_number(encoding, body, "I", len(raw))
        body += raw
    elif type == "time":
        put_number(encoding, body, "I", int(value))
        put_number(encoding, body, "I", round(value % 1 * 1e9))
    else:
        put_number(encoding, body, codes[type], value)


def put_number(encoding, body, code, value):
    if encoding is Encoding.CDR:
        body += b"\0" * (-len(body) % struct.calcsize(code))
    body += struct.pack("<" + code, value)


@given(number=st.integers(0, 2**40))
@example(127)
@example(128)
def test_varint(number):
    found = varint(number)
    assert sum((each & 127) << 7 * place for place, each in enumerate(found)) == number
    assert [each >> 7 for each in found] == [1] * (len(found) - 1) + [0]


def test_fields_that_protobuf_could_not_hold():
    """They are left out: protobuf's own attributes would be hidden by them."""
    definition = parse_definition("a/B", "float64 DESCRIPTOR\nfloat64 Clear\nfloat64 x")
    message = struct.pack("<I3d", 24, 1, 2, 3)
    found = read(definition, Encoding.ROS1, message)
    assert found.x == 3
    assert [each.name for each, _ in found.ListFields()] == ["x"]


def test_nan_stays():
    definition = DEFINITIONS[Encoding.ROS1].find("std_msgs/Float32")
    assert math.isnan(read(definition, Encoding.ROS1, struct.pack("<If", 4, math.nan)).data)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_header_only(encoding):
    type = "sensor_msgs/Image"
    made, _ = Generator(encoding, 1).message("sensor_msgs/msg/Image")
    made.header = header(encoding, "camera")
    found = read(
        DEFINITIONS[encoding].find(type), encoding, encode(encoding, type, made), ["header"]
    )
    assert found.header.frame_id == "camera"
    assert found.header.stamp == 3.5
    assert not found.HasField("data")
