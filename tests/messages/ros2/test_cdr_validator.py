"""A message is whole if it is one CDR message of its type to the last byte, and refused if not."""

import struct

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from message_samples import ROS2, Generator, encode

from example_budget import examples
from rtron.errors import WireError
from rtron.messages import DefinitionRegistry, Encoding, parse_definition
from rtron.messages.common.definition import SIZES
from rtron.messages.common.encoding import PADDING
from rtron.messages.ros2.cdr_validator import cdr_validator

DEFINITIONS = DefinitionRegistry(ros=2)
KINDS = sorted(ROS2.fielddefs)
FRONT = b"\0\1\0\0"
MOST = (1 << 32) - 1


class Plain(Generator):
    """Makes messages without a NUL in a string."""

    strings = ("", "a", "map", "ä€😀", "x" * 200)


def check(text):
    return cdr_validator(parse_definition("a/B", text))


def accepts(text, body):
    try:
        check(text)(FRONT + body)
    except WireError:
        return False
    return True


def string(text, *, count=None):
    return struct.pack("<I", len(text) if count is None else count) + text


@pytest.mark.parametrize("type", KINDS)
def test_every_standard_type(type):
    """What rosbags writes is whole; with a byte less or more than padding it is not."""
    look = cdr_validator(DEFINITIONS.find(type))
    for seed in range(5):
        message = encode(
            Encoding.CDR, type.replace("/msg/", "/"), Plain(Encoding.CDR, seed).message(type)[0]
        )
        look(message)
        look(message + bytes(PADDING))
        for other in (message[:-1], message + bytes(PADDING + 1)):
            with pytest.raises(WireError):
                look(other)


@pytest.mark.parametrize("type", ["nav_msgs/msg/Path", "diagnostic_msgs/msg/DiagnosticArray"])
def test_every_truncation(type):
    look = cdr_validator(DEFINITIONS.find(type))
    message = encode(
        Encoding.CDR, type.replace("/msg/", "/"), Plain(Encoding.CDR, 4).message(type)[0]
    )
    for length in range(len(message)):
        with pytest.raises(WireError):
            look(message[:length])


@settings(max_examples=examples(500), suppress_health_check=list(HealthCheck))
@given(type=st.sampled_from(KINDS), seed=st.integers(0, 2**32), data=st.data())
def test_fuzz_mutated(type, seed, data):
    """Whatever is made of a message, it is accepted or refused, and nothing else happens."""
    made = encode(
        Encoding.CDR, type.replace("/msg/", "/"), Plain(Encoding.CDR, seed).message(type)[0]
    )
    message = bytearray(made)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, max(len(message) - 1, 0)))
        change = data.draw(st.sampled_from(["bit", "count", "cut", "put"]))
        if change == "bit" and message:
            message[at] ^= 1 << data.draw(st.integers(0, 7))
        elif change == "count":
            number = data.draw(st.sampled_from([0, 1, 255, 1 << 16, 1 << 31, MOST]))
            message[at & ~3 : (at & ~3) + 4] = struct.pack("<I", number)
        elif change == "cut":
            del message[at:]
        else:
            message[at:at] = data.draw(st.binary(max_size=20))
    refusal(DEFINITIONS.find(type), bytes(message))


@settings(max_examples=examples(300), suppress_health_check=list(HealthCheck))
@given(type=st.sampled_from(KINDS), body=st.binary(max_size=400))
@example(type="nav_msgs/msg/Path", body=b"\xff" * 400)
@example(type="std_msgs/msg/Float64MultiArray", body=b"\0" * 12 + b"\xff" * 4)
def test_fuzz_random(type, body):
    refusal(DEFINITIONS.find(type), FRONT + body)
    refusal(DEFINITIONS.find(type), body)


def refusal(definition, message):
    """Return why a message is refused, nothing if it is not; nothing else may be raised."""
    try:
        cdr_validator(definition)(message)
    except WireError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("front", "whole"),
    [
        (b"\0\1\0\0", True),
        (b"\0\1\xff\xfc", True),
        (b"\0\1\0\1", False),
        (b"\0\0\0\0", False),
        (b"\0\3\0\0", False),
        (b"\0\7\0\0", False),
        (b"\1\1\0\0", False),
    ],
)
def test_encapsulation(front, whole):
    assert (refusal(parse_definition("a/B", "int8 x"), front + b"\5") == "") is whole


@pytest.mark.parametrize("announced", range(4))
@pytest.mark.parametrize("there", range(4))
def test_padding_that_is_announced_is_there(announced, there):
    message = bytes([0, 1, 0, announced, 5]) + bytes(there)
    refused = refusal(parse_definition("a/B", "int8 x"), message)
    assert bool(refused) is (announced > there), refused


@pytest.mark.parametrize("length", range(4))
def test_not_even_an_encapsulation(length):
    assert "has not even" in refusal(parse_definition("a/B", ""), FRONT[:length])


@pytest.mark.parametrize(("value", "whole"), [(0, True), (1, True), (2, False), (255, False)])
def test_a_boolean_is_0_or_1(value, whole):
    assert accepts("bool x", bytes([value])) is whole
    assert accepts("int32 a\nbool x\nint32 b", bytes([0, 0, 0, 9, value]) + bytes(7)) is whole
    assert accepts("bool[3] x", bytes([1, 0, value])) is whole
    assert accepts("bool[] x", string(bytes([1, 0, value]))) is whole
    inner = "\n===\nMSG: a/C\nint8 n\nbool y"
    assert accepts(f"C[] x{inner}", struct.pack("<I4B", 2, 9, 1, 9, value)) is whole


@pytest.mark.parametrize(
    ("body", "whole"),
    [
        (string(b"\0"), True),
        (string(b"ab\0"), True),
        (string(b"\xff\xfe\0"), True),
        (string(b""), False),
        (string(b"ab"), False),
        (string(b"a\0b\0"), False),
        (string(b"\0\0"), False),
        (string(b"ab\0", count=2), False),
        (string(b"ab\0", count=4), False),
        (string(b"\0", count=MOST), False),
    ],
)
def test_a_string_ends_once_and_at_its_end(body, whole):
    assert accepts("string x", body) is whole
    assert accepts("string[] x", struct.pack("<I", 1) + body) is whole
    assert accepts("string[1] x", body) is whole


@pytest.mark.parametrize(("length", "whole"), [(0, True), (2, True), (3, True), (4, False)])
def test_bounds(length, whole):
    text = b"x" * length + b"\0"
    assert accepts("string<=3 x", string(text)) is whole
    assert accepts("string<=3[] x", struct.pack("<I", 1) + string(text)) is whole
    assert accepts("string<=3[1] x", string(text)) is whole
    assert accepts("int8[<=3] x", string(bytes(length))) is whole
    assert accepts("bool[<=3] x", string(bytes(length))) is whole
    inner = "\n===\nMSG: a/C\n"
    assert accepts(f"C[<=3] x{inner}int8 y", string(bytes(length))) is whole
    assert accepts(f"C[<=3] x{inner}bool y", string(bytes(length))) is whole
    strings = struct.pack("<I", length) + struct.pack("<II", 1, 0) * length
    assert accepts("string[<=3] x", strings) is whole


@pytest.mark.parametrize("item", ["int8", "float64", "bool", "string", "C", "D", "E"])
def test_counts_that_cannot_fit(item):
    """Such a count is refused before anything of that size is made or gone over."""
    nested = "".join(
        f"\n===\nMSG: a/{name}\n{fields}"
        for name, fields in (("C", "float64 y"), ("D", "string y"), ("E", ""))
    )
    look = check(f"{item}[] x{nested}")
    for count in (5000, 1 << 31, MOST):
        with pytest.raises(WireError, match="are announced"):
            look(FRONT + struct.pack("<I", count) + bytes(4096))


PRIMITIVES = sorted(set(SIZES) - {"bool"})


@settings(max_examples=examples(500))
@given(
    before=st.integers(0, 9),
    types=st.lists(st.sampled_from(PRIMITIVES), max_size=4),
    length=st.one_of(st.none(), st.integers(1, 40)),
    count=st.integers(0, 40),
)
@example(before=3, types=["uint8", "float64"], length=None, count=9)
@example(before=0, types=["float64", "uint8"], length=None, count=33)
@example(before=1, types=[], length=None, count=5)
def test_arrays_of_plain_messages(before, types, length, count):
    """They are gone over in leaps that end where going over each one would."""
    name = string(b"x" * before + b"\0")
    at = len(name)
    if length is None:
        at += -at % 4
        name += bytes(at - len(name)) + struct.pack("<I", count)
        at += 4
    for _ in range(count if length is None else length):
        for size, align in [(SIZES[each], min(SIZES[each], alignment(each))) for each in types] or [
            (1, 1)
        ]:
            at += -at % align + size
    body = name + bytes(at - len(name))
    fields = "\n".join(f"{each} x{number}" for number, each in enumerate(types))
    text = f"string name\nC[{length or ''}] many\n===\nMSG: a/C\n{fields}"
    assert accepts(text, body)
    assert accepts(text, body + bytes(PADDING))
    assert not accepts(text, body + bytes(PADDING + 1))
    assert not accepts(text, body[:-1])


def alignment(type):
    return 4 if type in ("time", "duration") else SIZES[type]


def test_plain_messages_in_plain_messages():
    text = "C[] x\n===\nMSG: a/C\nD[2] y\nuint8 z\n===\nMSG: a/D\nfloat64 w\nuint16[3] v"
    each = struct.pack("<d3H2xd3HB", 1.0, 1, 2, 3, 2.0, 1, 2, 3, 1)
    second = bytes(-len(each) % 8) + each
    assert accepts(text, struct.pack("<II", 2, 0) + each + second)
    assert not accepts(text, struct.pack("<II", 2, 0) + each + second[:-1])
    assert not accepts(text, struct.pack("<II", 3, 0) + each + second)
