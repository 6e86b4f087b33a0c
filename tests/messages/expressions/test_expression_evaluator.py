"""Expressions over message fields: checked against the definition, and evaluated."""

import math
import struct
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from message_samples import ENCODINGS, POSE, encode, header, make, pose_stamped, square

from cpu_time import growth
from example_budget import examples
from rtron.errors import InputError
from rtron.messages import (
    DefinitionRegistry,
    Encoding,
    MessageEvaluator,
    check_expression,
    parse_definition,
)
from rtron.messages.expressions.compiler import MAX_EXPRESSION
from rtron.vocabulary import Area, Point

pytest.importorskip("cel_expr_python.cel", reason="no CEL on this machine")
KNOWN = {Encoding.ROS1: DefinitionRegistry(), Encoding.CDR: DefinitionRegistry(ros=2)}
KINDS = """
bool flag
byte octet
char letter
int8 a
uint8 b
int16 c
uint16 d
int32 e
uint32 f
int64 g
uint64 h
float32 i
float64 j
string s
time t
duration u
uint8[] data
char[3] letters
int8[] small
float32[] ranges
string[] names
Inner inner
Inner[] list
time[] times
====
MSG: a/Inner
float64 x
string label
"""
INNERS = struct.pack("<dI3s", 2.5, 3, b"cat")
BODY = (
    struct.pack("<BbBbBhHiIqQfd", 2, -1, 200, -5, 250, -300, 65535, -7, 2**32 - 1, -9, 2**63 - 1,
                0.5, 1e300)
    + struct.pack("<I3s", 3, b"abc") + struct.pack("<II", 10, 500_000_000)
    + struct.pack("<ii", -1, 500_000_000) + struct.pack("<I2s", 2, b"\1\2") + b"xyz"
    + struct.pack("<Ibb", 2, -1, 1) + struct.pack("<I2f", 2, 0.25, 9.0)
    + struct.pack("<II1sI2s", 2, 1, b"n", 2, b"mm") + INNERS + struct.pack("<I", 2) + INNERS * 2
    + struct.pack("<III", 1, 7, 0)
)  # fmt: skip
MESSAGE = struct.pack("<I", len(BODY)) + BODY


def judge(text, message=MESSAGE, definition=None, **more):
    kinds = {"subject": "event", "encoding": Encoding.ROS1} | more
    known = definition or parse_definition("a/Kinds", KINDS)
    (found,) = MessageEvaluator(known, [text], **kinds).evaluate(message)
    return found


@pytest.mark.parametrize(
    "text",
    [
        "event.flag",
        "event.flag == true",
        "event.octet == -1",
        "event.letter == 200",
        "event.a == -5 && event.b == 250 && event.c == -300 && event.d == 65535",
        "event.e == -7 && event.f == 4294967295 && event.g == -9",
        "event.h == 9223372036854775807",
        "event.i == 0.5 && event.j > 1e299",
        "event.s == 'abc' && event.s.startsWith('a') && event.s.matches('^[a-c]+$')",
        "event.t == 10.5 && event.u == -0.5",
        r"event.data == b'\x01\x02' && size(event.data) == 2",
        "event.letters == b'xyz'",
        "event.small == [-1, 1] && event.small[0] < 0",
        "event.ranges.exists(r, r < 0.3) && !event.ranges.all(r, r < 0.3)",
        "event.ranges.filter(r, r > 1.0).size() == 1",
        "event.names.exists(name, name == 'mm') && 'n' in event.names",
        "event.inner.x > 2.0 && event.inner.label == 'cat'",
        "event.list.exists(one, one.label == 'cat' && one.x > 2.0)",
        "event.list.map(one, one.x) == [2.5, 2.5]",
        "event.list[1] == event.inner",
        "event.times[0] == 7.0",
        "has(event.inner) && has(event.flag) && has(event.inner.x)",
        "event == event",
        "[event].exists(e, e.a == -5)",
        "event // why\n.a == -5",
        ".event.a == -5",
        "true",
    ],
)
def test_true(text):
    assert judge(text) is True
    assert judge(f"!({text}\n)") is False


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("event.ranges[2] > 1.0", "Index error: index=2 size=2"),
        ("event.a / (event.a + 5) == 1", "divide by zero"),
        ("event.g + event.h * 2 > 0", "integer overflow"),
        ("event.s.matches(event.names[0] + '(')", "invalid regular expression: missing ): n("),
        ("int(event.s) == 1", None),
        ("dyn(event).nothing == 1", "no_such_field : nothing"),
    ],
)
def test_not_known(text, why):
    found = judge(text)
    assert isinstance(found, str)
    assert why is None or why in found
    assert judge(f"{text} || event.flag") is True
    assert judge(f"!event.flag && {text}") is False


@pytest.mark.parametrize(
    "text",
    ["event == a.B{}", "[event].exists(e, e == a.B{})", "event // x\n== a.B{}", ".event==a.B{}"],
)
def test_a_message_as_a_whole_has_all_its_fields(text):
    assert judge(text, b"\1\0\0\0\1", parse_definition("a/B", "bool x")) is False


@pytest.mark.parametrize("value", [0.0, -0.0, 1.0])
def test_has_tells_of_fields_not_of_values(value):
    definition = KNOWN[Encoding.ROS1].find("std_msgs/Float64")
    assert judge("has(event.data)", struct.pack("<Id", 8, value), definition) is True


@pytest.mark.parametrize(
    ("text", "said", "help"),
    [
        ("event.flg", "column 6 of the expression: a/Kinds has no field 'flg'", "mean flag?"),
        ("event.inner.y > 1.0", "column 12 of the expression: a/Inner has no field", "label, x"),
        ("event.list.exists(o, o.z > 1.0)", "column 23 of the expression: a/Inner has no", "label"),
        ("evnt.flag", "column 5 of the expression: nothing is called 'evnt'", "mean event?"),
        ("event.a > 1.0", "column 9 of the expression: > cannot be applied to (int, double)",
         "1.0 instead of 1"),
        ("event.j > 1", "column 9 of the expression: > cannot be applied to (double, int)",
         "1.0 instead of 1"),
        ("event.s == 1", "== cannot be applied to (string, int)", "same type"),
        ("event.ranges.exists(r, r > 1)", "(double, int)", "1.0 instead of 1"),
        ("-event.s == ''", "- cannot be applied to (string)", "same type"),
        ("true\n&& event.flg", "line 2, column 9 of the expression", "flag"),
        ("event.a", "gives INT, not a truth", "compare"),
        ("event", "gives a.Kinds, not a truth", "compare"),
        ("dyn(event.a)", "not a truth", "compare"),
        ("event.a >", "column 10 of the expression: Syntax error", "cel.dev"),
        ("", "column 1 of the expression: Syntax error", "cel.dev"),
        ("'", "column 1 of the expression: Syntax error", "cel.dev"),
        ("event.s == 'ä€😀' && event.bad", "column 26 of the expression", "choose from"),
        ("x" * 100 + " == 1", "nothing is called", "choose from"),
        ("event.flag\ud800", "column 11: not a character", ""),
        ("(" * 500 + "true" + ")" * 500, "recursion limit", "simpler"),
        ("1" + "+1" * 500 + " == 1", "recursion", "simpler"),
        ("[" * 500 + "]" * 500 + " == []", "recursion limit", "simpler"),
        ("inside(event.inner, zone)", "inside cannot be applied to (a.Inner, rtron.Area)", "Point"),
        ("zon == zone", "nothing is called 'zon'", "mean zone?"),
        ("place(1, 2) == place(1.0, 2.0)", "place cannot be applied to (int, int)", "place(3.0"),
    ],
)  # fmt: skip
def test_refused(text, said, help):
    frame = "map" if "place" in text else ""
    definition = parse_definition("a/Kinds", KINDS)
    with pytest.raises(InputError) as refused:
        check_expression(definition, text, "event", [square()], frame=frame)
    assert said in str(refused.value)
    assert help in refused.value.help


def test_length_of_a_text():
    definition = parse_definition("a/B", "bool x")
    check_expression(definition, "true" + " " * (MAX_EXPRESSION - 4), "event")
    with pytest.raises(InputError, match="longer than"):
        check_expression(definition, "true" + " " * (MAX_EXPRESSION - 3), "event")


def test_check_expression():
    definition = KNOWN[Encoding.ROS1].find(POSE)
    check_expression(definition, "inside(action.pose.position, zone)", "action", [square()])
    check_expression(definition, "action.pose.position.x > 1.0", "action", frame="map")
    with pytest.raises(InputError, match="nothing is called 'event'"):
        check_expression(definition, "event.pose.position.x > 1.0", "action")


def test_many_texts_keep_their_order():
    texts = [
        "event.a == -5",
        "event.flg",
        "event.s == ''",
        "event.a == -5",
        "event.ranges[5] > 1.0",
    ]
    definition = parse_definition("a/Kinds", KINDS)
    with pytest.raises(InputError):
        MessageEvaluator(definition, texts, subject="event", encoding=Encoding.ROS1)
    texts[1] = "event.flag"
    found = MessageEvaluator(definition, texts, subject="event", encoding=Encoding.ROS1).evaluate(
        MESSAGE
    )
    assert found[:4] == (True, True, False, True)
    assert "Index" in found[4]
    assert (
        MessageEvaluator(definition, [], subject="event", encoding=Encoding.ROS1).evaluate(MESSAGE)
        == ()
    )


def test_each_text_is_evaluated_once(monkeypatch):
    asked = []
    monkeypatch.setattr(
        "rtron.messages.expressions.evaluator.evaluate",
        lambda text, activation: asked.append(text) or True,
    )
    definition = parse_definition("a/Kinds", KINDS)
    judged = MessageEvaluator(
        definition, ["event.flag", "!event.flag"] * 25, subject="event", encoding=Encoding.ROS1
    )
    assert judged.evaluate(MESSAGE) == (True,) * 50
    assert len(asked) == 2


@pytest.mark.parametrize("length", range(0, len(MESSAGE), 7))
def test_malformed(length):
    found = MessageEvaluator(
        parse_definition("a/Kinds", KINDS), ["event.flag", "true"], subject="event",
        encoding=Encoding.ROS1,
    ).evaluate(MESSAGE[:length])  # fmt: skip
    assert isinstance(found[0], str)
    assert found == (found[0],) * 2


def test_integers_above_int64():
    definition = KNOWN[Encoding.ROS1].find("std_msgs/UInt64")
    found = [
        judge("event.data > 5", struct.pack("<IQ", 8, 2**63 - 1 + n), definition) for n in (0, 1)
    ]
    assert found[0] is True
    assert "above" in found[1]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_positions_that_are_no_numbers(value):
    message = pose_stamped(Encoding.ROS1, x=value)
    definition = KNOWN[Encoding.ROS1].find(POSE)
    for text in ("inside(event.pose.position, zone)", "distance(event.pose.position, zone) > 1.0"):
        assert judge(text, message, definition, areas=[square()]) == "a position is not finite"


def test_reserved_names_of_fields():
    names = ["in", "if", "package", "true", "for", "size", "self", "None", "Clear", "has"]
    definition = parse_definition("a/B", "".join(f"float64 {name}\n" for name in names))
    message = struct.pack(f"<I{len(names)}d", 8 * len(names), *range(1, len(names) + 1))
    for number, name in enumerate(names, 1):
        text = f"event.`{name}` == {number}.0"
        if name == "Clear":
            with pytest.raises(InputError, match="no field"):
                judge(text, message, definition)
        else:
            assert judge(text, message, definition) is True


@pytest.mark.parametrize("type", ["event/event", "int/Bool", "google/Any", "a/B", "size/x"])
def test_strange_names_of_types(type):
    assert judge("event.x", b"\1\0\0\0\1", parse_definition(type, "bool x")) is True


def test_a_type_that_is_called_as_one_of_python():
    """The library takes its values for Python's own: not known, never true."""
    assert "Unexpected value type" in judge(
        "event.x", b"\1\0\0\0\1", parse_definition("a/bool", "bool x")
    )


@pytest.mark.parametrize("type", ["rtron/Area", "google/protobuf"])
def test_names_of_types_that_are_taken(type):
    with pytest.raises(InputError):
        judge("event.x", b"\1\0\0\0\1", parse_definition(type, "bool x"))


@pytest.mark.parametrize("name", ["event", "inside", "place", "in", "true", "a b", "1a", "", "ä"])
def test_names_of_areas(name):
    with pytest.raises(InputError, match="cannot be called"):
        check_expression(KNOWN[Encoding.ROS1].find(POSE), "true", "event", [square(name)])


def test_area_with_two_corners():
    line = Area(name="line", frame="map", polygon=(Point(x=0.0, y=0.0), Point(x=1.0, y=1.0)))
    with pytest.raises(InputError, match="fewer than 3"):
        check_expression(KNOWN[Encoding.ROS1].find(POSE), "true", "event", [line])


def test_without_cel(monkeypatch):
    for module in ("cel_expr_python", "cel_expr_python.cel", "celpy"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(InputError, match="the package cel-expr-python or cel-python") as refused:
        check_expression(parse_definition("a/B", "bool x"), "event.x", "event")
    assert "pip install cel-python" in refused.value.help


NESTED = "event.ranges.all(a, event.ranges.all(b, event.ranges.all(c, event.ranges.all(d, true))))"


def test_loops_are_bounded():
    body = struct.pack("<I", 1000) + bytes(4000)
    message = struct.pack("<I", len(body)) + body
    found = judge(NESTED, message, parse_definition("a/B", "float32[] ranges"))
    assert "budget" in found


TRICKY = [
    "inside(event.pose.position, zone) && 'inside(a, b)' != \"inside(c, d)\"",
    "inside (event.pose.position // where, )\n, zone // why\n)",
    "[zone].exists(z, inside(event.pose.position, z))",
    r"'\'inside(' != '' && r'\d' == '\\d' && inside(event.pose.position, zone)",
    "[true].exists(inside, inside) && inside(event.pose.position, zone)",
    "'''it's inside(''' != '' && inside(event.pose.position, zone)",
    "[event.pose.position].all(p, inside(p, zone) && distance(p, zone) == 0.0)",
    "distance([event.pose.position, place(0.0, 0.0)][0], place(1.0, 5.0)) == 3.0",
    "distance(place(distance(event.pose.position, zone), 0.0), place(0.0, 2.0)) == 2.0",
    "inside(event.header.seq > 5 ? event.pose.position : place(-1.0, -1.0), zone)",
]


@pytest.mark.parametrize("text", TRICKY)
def test_positions_in_any_place_of_a_text(text):
    definition = KNOWN[Encoding.ROS1].find(POSE)
    message = pose_stamped(Encoding.ROS1)
    assert judge(text, message, definition, areas=[square()], frames=["map"]) is True


def test_an_area_of_a_distance_is_called_by_its_name():
    with pytest.raises(InputError, match="too deep a way"):
        judge("[zone].exists(z, distance(event.pose.position, z) < 1.0)", b"",
              KNOWN[Encoding.ROS1].find(POSE), areas=[square()])  # fmt: skip


def test_no_memory_is_lost():
    """Functions in Python lost a kilobyte a call."""
    judged = MessageEvaluator(
        KNOWN[Encoding.ROS1].find(POSE),
        TRICKY[:1],
        subject="event",
        encoding=Encoding.ROS1,
        areas=[square()],
    )
    message = pose_stamped(Encoding.ROS1)
    sizes = []
    for _ in range(2):
        for _ in range(5000):
            judged.evaluate(message)
        sizes.append(int(Path("/proc/self/statm").read_text().split()[1]))
    assert (sizes[1] - sizes[0]) * 4096 < 5000 * 100


def test_regular_expressions_take_linear_time():
    definition = KNOWN[Encoding.ROS1].find("std_msgs/String")

    def match(length):
        message = struct.pack("<II", length + 4, length) + b"a" * length
        assert judge("event.data.matches('^(a+)+b$')", message, definition) is False

    assert growth(match, 200_000, 2_000_000) < 30


@settings(max_examples=examples(300))
@given(
    text=st.text(max_size=40)
    | st.lists(
        st.sampled_from(
            ["event", ".", "flag", "a", "list", "exists", "(", ")", ",", "o", ">", "1", "1.0", "&&",
             "!", "'", "`", "[", "]", "{", "}", "?", ":", "//", "\n", "inside", "zone", "dyn", "\0"]
        ),
        max_size=25,
    ).map("".join)
)  # fmt: skip
def test_fuzz_expression(text):
    try:
        found = judge(text, areas=[square()])
    except InputError:
        return
    assert isinstance(found, bool | str)


BOTH = [
    "event.header.frame_id == 'map' && event.header.stamp == 3.5",
    "event.pose.position.y == 2.0",
]


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_either_encoding(encoding):
    judged = MessageEvaluator(KNOWN[encoding].find(POSE), BOTH, subject="event", encoding=encoding)
    assert judged.evaluate(pose_stamped(encoding)) == (True, True)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_points_of_32_bits(encoding):
    type = "geometry_msgs/PolygonStamped"
    corner = make(encoding, "geometry_msgs/Point32", 1.0, 2.0, 0.0)
    polygon = make(encoding, "geometry_msgs/Polygon", [corner] * 3)
    message = encode(encoding, type, make(encoding, type, header(encoding), polygon))
    text = "event.polygon.points.all(p, inside(p, zone) && distance(p, place(1.0, 5.0)) == 3.0)"
    judged = MessageEvaluator(
        KNOWN[encoding].find(type), [text], subject="event", encoding=encoding, areas=[square()]
    )
    assert judged.evaluate(message) == (True,)
