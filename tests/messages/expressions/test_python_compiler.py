"""The expressions that are compiled in Python have the values that Google's CEL gives."""

import math
import struct

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from message_samples import POSE, pose_stamped, square

from example_budget import examples
from rtron.errors import InputError
from rtron.messages import DefinitionRegistry, Encoding, MessageEvaluator, parse_definition
from rtron.messages.expressions import compiler

pytest.importorskip("celpy", reason="no cel-python on this machine")
ROBOT = parse_definition(
    "a/Robot",
    "bool flag\nint32 count\nint64 large\nfloat64 speed\nstring name\nuint8[] data\n"
    "float32[] ranges\nint8[] steps\nstring[] names\nInner inner\nInner[] parts\n"
    "====\nMSG: a/Inner\nfloat64 x\nstring label\n",
)
NO_GOOGLE = "no CEL of Google's on this machine"
ELSEWHERE = "needs the package cel-expr-python"


def robot(*, flag=True, count=3, speed=0.5, name="map", ranges=(0.5, 2.0), large=9):
    """Return a message of type `ROBOT`."""
    part = struct.pack("<dI1s", 1.5, 1, b"n")
    text = name.encode()
    body = struct.pack("<Biqd", flag, count, large, speed)
    body += struct.pack(f"<I{len(text)}s", len(text), text) + struct.pack("<I2s", 2, b"\1\2")
    body += struct.pack(f"<I{len(ranges)}f", len(ranges), *ranges) + struct.pack("<I2b", 2, -1, 4)
    body += struct.pack("<II3sI1s", 2, 3, b"map", 1, b"b") + part + struct.pack("<I", 2) + part * 2
    return struct.pack("<I", len(body)) + body


def in_python(text, message=None, definition=ROBOT, **more):
    """Return what an expression gives where Google's CEL is not installed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiler, "_google_cel", lambda: None)
        return in_google(text, message, definition, **more)


def in_google(text, message=None, definition=ROBOT, **more):
    """Return what an expression gives, with Google's CEL where that is installed."""
    evaluator = MessageEvaluator(
        definition, [text], subject="event", encoding=Encoding.ROS1, **more
    )
    return evaluator.evaluate(robot() if message is None else message)[0]


@pytest.mark.parametrize(
    "text",
    [
        "event.flag && event.count == 3 && event.speed > 0.25 && event.name == 'map'",
        "event.count + 2 * 3 - 10 / 3 == 6 && -7 / 2 == -3 && -7 % 2 == -1 && event.count-1 == 2",
        "event.ranges.exists(r, r < 1.0) && !event.ranges.all(r, r < 1.0)",
        "event.ranges.filter(r, r > 1.0).size() == 1 && size(event.names) == 2",
        "event.ranges.map(r, r * 2.0) == [1.0, 4.0] && event.ranges.exists_one(r, r == 2.0)",
        "'b' in event.names && !(7 in event.steps) && event.steps == [-1, 4]",
        "event.parts.exists(part, part.label == 'n' && part.x > event.speed)",
        "event.parts[1].x == 1.5 && event.inner.label == 'n' && has(event.inner.x)",
        r"event.name.startsWith('m') && event.name.matches('^m[a-z]+$')",
        r"event.data == b'\x01\x02'",
        "event.name + 'x' == \"mapx\" && event.name.contains('a') && '\\u00e4'.size() == 1",
        "math.greatest(event.speed, 0.25) == 0.5 && math.least([3, 1, 2]) == 1",
        "int(event.speed) == 0 && double(event.count) == 3.0 && !math.isNaN(event.speed)",
        "event.ranges.exists(r, event.ranges.exists(s, r < s)) || event.ranges[7] > 1.0",
        "event.flag ? event.count > 2 : event.ranges[9] > 1.0",
        "event // a comment\n.count == 3",
        "1.0 / 0.0 > event.speed && 0x10 == 16 && 1e-3 < 0.01",
        r"'\101\x41\X41\u0041\U00000041\?\`' == 'AAAAA?`' && r'\q' == '\\q' && '\xe4' == 'ä'",
        r"b'\377\X01\n' == b'\xff\x01\x0a' && br'ä' == b'\303\244' && b'\?' == br'?'",
    ],
)
def test_what_holds(text):
    assert in_python(text) is True
    assert in_python(f"!({text}\n)") is False


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("event.ranges[2] > 1.0", "Index error: index=2 size=2"),
        ("event.count / (event.count - 3) == 1", "divide by zero"),
        ("event.count % 0 == 1", "modulus by zero"),
        ("event.count + 9223372036854775807 > 0", "integer overflow"),
        ("event.name.matches(event.name + '(')", "invalid regular expression"),
        ("0.0 / 0.0 < event.speed", "a number is NaN"),
        ("event.ranges.exists(r, r > event.ranges[9])", "Index error"),
        ("math.greatest(event.ranges.filter(r, false)) > 1.0", "an empty list has no greatest"),
        (
            "math.least(event.ranges.filter(r, false)) > 1.0",
            "an empty list has no greatest or least",
        ),
    ],
)
def test_what_is_not_known(text, said):
    assert said in in_python(text)
    assert in_python(f"{text} || event.flag") is True
    assert in_python(f"!event.flag && {text}") is False


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("event.flg", "column 6 of the expression: a/Robot has no field 'flg'"),
        ("event.parts.exists(o, o.z > 1.0)", "a/Inner has no field 'z'"),
        ("evnt.flag", "nothing is called 'evnt'"),
        ("event.count > 1.0", "column 13 of the expression: > cannot be applied to (int, double)"),
        ("event.ranges.exists(r, r > 1)", "(double, int)"),
        ("-event.name == ''", "- cannot be applied to (string)"),
        ("event.count", "gives INT, not a truth"),
        ("event", "gives a.Robot, not a truth"),
        ("event.count >", "Syntax error"),
        ("", "Syntax error"),
        ("(" * 80 + "event.flag" + ")" * 80, "recursion limit"),
        ("1" + "+1" * 80 + " == 81", "recursion limit"),
        ("(" * 80 + "!" * 80 + "event.flag" + ")" * 80, "recursion limit"),
        ("9223372036854775808 > 1", "invalid int literal"),
        (r"event.name == '\q'", r"column 15 of the expression: illegal escape sequence \q"),
        (r"event.name == '\777'", r"illegal escape sequence \7"),
        (r"event.name == '\uD800'", r"illegal escape sequence \uD800: no character"),
        (r"event.data == '\UFFFFFFFF'", r"illegal escape sequence \UFFFFFFFF: no character"),
        (r"event.data == b'\777'", r"illegal escape sequence \7"),
        (r"event.data == b'\u0041'", r"\u0041 cannot be used in bytes"),
        (r"event.name == r'a\'b'", "is not one literal"),
        ("1.==1.0", "a digit must follow the point of 1."),
        ("startsWith(event.name, 'a')", "startsWith cannot be applied to (string, string)"),
        ("contains(event.name, 'a')", "contains cannot be applied to (string, string)"),
        ("event.count.int() == 1", "int cannot be applied to (int)"),
        (".size(event.name) == 1", ELSEWHERE),
        ("event.ranges.exists(package, true)", "column 21 of the expression: reserved identifier"),
        ("event.ranges.exists(in, true)", "reserved identifier: in"),
        ("event.ranges.exists(__result__, true)", "reserved identifier: __result__"),
        ("[1] in [[], [true]]", "in cannot be applied to (list(int), list(list(bool)))"),
        ("[[], [1], [true]] == []", ELSEWHERE),
        ("[[], [1]].exists(each, each == [true])", "== cannot be applied to (list(int), list(bool"),
        ("(event.flag ? [] : [1]) == [true]", "== cannot be applied to (list(int), list(bool))"),
        ("[[]].exists(each, each == [1])", ELSEWHERE),
        ("event.name.foo()", "foo cannot be applied to (string)"),
        ("event.ranges.exists(r)", ELSEWHERE),
        ("dyn(event.count) == 3", f"dyn(int) {ELSEWHERE}"),
        ("type(1) == int", f"type(int) {ELSEWHERE}"),
        ("string(1) == '1'", f"string(int) {ELSEWHERE}"),
        ("int('1') == 1", f"int(string) {ELSEWHERE}"),
        ("int(event.flag) == 1", "int cannot be applied to (bool)"),
        ("event.name.int() == 1", "int cannot be applied to (string)"),
        ("math.ceil(event.speed) == 1.0", f"math.ceil(double) {ELSEWHERE}"),
        ("math.ceil(event.name) == 1.0", "math.ceil cannot be applied to (string)"),
        ("math.round(1.5) == 2.0", f"math.round(double) {ELSEWHERE}"),
        ("math.sign(1) == 1", f"math.sign(int) {ELSEWHERE}"),
        ("math.bitAnd(1, 3) == 1", f"math.bitAnd(int, int) {ELSEWHERE}"),
        ("math.greatest(1, 2.0) == 2.0", f"math.greatest(int, double) {ELSEWHERE}"),
        ("[1] + [2] == [1, 2]", f"+ of lists {ELSEWHERE}"),
        ("[1] + ['a'] == [1]", "+ cannot be applied to (list(int), list(string))"),
        ("[][0] == 1", ELSEWHERE),
        ("event == event", ELSEWHERE),
        ("{'a': 1}['a'] == 1", ELSEWHERE),
        ("1u == 1u", ELSEWHERE),
        ("[1, 2.0] == [1]", ELSEWHERE),
    ],
)
def test_what_is_refused(text, said):
    with pytest.raises(InputError) as refused:
        in_python(text)
    assert said in str(refused.value)


def test_macros_are_bounded():
    nested = "event.ranges.all(a, event.ranges.all(b, event.ranges.all(c, true)))"
    assert in_python(nested, robot(ranges=(1.0,) * 21)) is True
    assert "budget" in in_python(f"{nested} || true", robot(ranges=(1.0,) * 22))


def test_a_refused_macro_leaves_no_variable():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiler, "_google_cel", lambda: None)
        expressions = compiler.ExpressionCompiler(ROBOT, "event")
    with pytest.raises(InputError, match="cannot be applied"):
        expressions.compile("event.ranges.exists(r, r > 1)")
    with pytest.raises(InputError, match="nothing is called 'r'"):
        expressions.compile("r > 1.0")


@pytest.mark.parametrize(
    "text",
    [
        "event.pose.position.inside(zone)",
        "event.pose.position.distance(zone) < 1.0",
        "distance(event.pose.position, 1.0.place(2.0)) < 1.0",
        "distance(event.pose.position, (zone)) < 1.0",
        "[1.0].exists(zone, distance(event.pose.position, zone) < 1.0)",
        "[event.pose.position].exists(zone, distance(event.pose.position, zone) < 1.0)",
    ],
)
@pytest.mark.parametrize("compile", [in_python, in_google])
def test_places_that_are_refused(compile, text):
    message, definition = pose_stamped(Encoding.ROS1), DefinitionRegistry().find(POSE)
    with pytest.raises(InputError, match=r"cannot be applied|nothing is called|too deep"):
        compile(text, message, definition, areas=[square()], frames=["map"])


PLACES = [
    "inside(event.pose.position, zone)",
    "distance(event.pose.position, zone) > 1.0",
    "distance(event.pose.position, place(0.0, 0.0)) < 2.5",
    "[zone].exists(z, inside(event.pose.position, z)) && event.header.frame_id == 'map'",
]


@pytest.mark.parametrize("text", PLACES)
@settings(max_examples=examples(30))
@given(x=st.floats(-9, 9) | st.sampled_from([0.0, 4.0, math.nan]), y=st.floats(-9, 9))
def test_places_are_where_google_s_cel_has_them(text, x, y):
    pytest.importorskip("cel_expr_python.cel", reason=NO_GOOGLE)
    definition = DefinitionRegistry().find(POSE)
    message = pose_stamped(Encoding.ROS1, x=x, y=y)
    found = in_python(text, message, definition, areas=[square()], frames=["map"])
    assert found == in_google(text, message, definition, areas=[square()], frames=["map"])


def _binary(operators, side):
    return st.tuples(side, st.sampled_from(operators), side).map(lambda each: f"({' '.join(each)})")


def _list_macro(body):
    over = st.sampled_from(["exists", "all", "exists_one"])
    return st.tuples(over, body).map(lambda each: f"event.ranges.{each[0]}(r, {each[1]})")


NUMBERS = st.recursive(
    st.sampled_from(["event.count", "event.large", "0", "-1", "3", "size(event.ranges)",
                     "event.steps[0]", "9223372036854775807"]),
    lambda inner: _binary(["+", "-", "*", "/", "%"], inner) | inner.map("-({})".format),
    max_leaves=4,
)  # fmt: skip
REALS = st.recursive(
    st.sampled_from(["event.speed", "0.0", "0.5", "event.ranges[1]", "event.inner.x",
                     "double(event.count)", "math.abs(event.speed)"]),
    lambda inner: _binary(["+", "-", "*", "/"], inner) | inner.map("-({})".format),
    max_leaves=4,
)  # fmt: skip
TEXTS = st.sampled_from(["event.name", "'map'", "''", "event.names[0]", "event.inner.label"])
_ORDER = ["<", "<=", ">", ">=", "==", "!="]
TRUTHS = st.recursive(
    st.sampled_from(["event.flag", "true", "false", "has(event.ranges)", "('b' in event.names)"])
    | _binary(_ORDER, NUMBERS)
    | _binary(_ORDER, REALS)
    | _binary(_ORDER, TEXTS)
    | _list_macro(_binary(_ORDER, st.just("r") | REALS)),
    lambda inner: (
        _binary(["&&", "||", "=="], inner)
        | inner.map("!({})".format)
        | st.tuples(inner, inner, inner).map(lambda each: "({} ? {} : {})".format(*each))
        | _list_macro(inner)
    ),
    max_leaves=6,
)


@settings(max_examples=examples(400), deadline=None)
@given(
    text=TRUTHS,
    flag=st.booleans(),
    count=st.sampled_from([0, 1, -3, 2**31 - 1]),
    speed=st.sampled_from([0.0, 0.5, -0.5, 1e308, math.inf, math.nan]),
    ranges=st.sampled_from([(), (0.5,), (2.0, 0.5), (0.25, math.nan, 1.0)]),
)
@example(text="event.ranges.all(r, r < 1.0)", flag=True, count=0, speed=0.0, ranges=(math.nan, 2.0))
def test_generated_expressions_have_google_s_values(text, flag, count, speed, ranges):
    pytest.importorskip("cel_expr_python.cel", reason=NO_GOOGLE)
    message = robot(flag=flag, count=count, speed=speed, ranges=ranges)
    expected, found = in_google(text, message), in_python(text, message)
    assert found is expected if isinstance(expected, bool) else isinstance(found, str), expected


WORDS = ["event", ".", "flag", "count", "speed", "ranges", "exists", "(", ")", ",", "r", ">", "==",
         "1", "1.0", "&&", "!", "'a'", "[", "]", "?", ":", "-", "size", "in", "has", "true",
         "math.abs", "startsWith", "int", "package", r"'\q'", r"'\uD800'", "1.", "[]"]  # fmt: skip


@settings(max_examples=examples(300), deadline=None)
@given(st.lists(st.sampled_from(WORDS), max_size=12).map(" ".join))
def test_what_python_accepts_google_s_cel_accepts(text):
    pytest.importorskip("cel_expr_python.cel", reason=NO_GOOGLE)
    try:
        found = in_python(text)
    except InputError:
        return
    expected = in_google(text)
    assert found is expected or (isinstance(found, str) and isinstance(expected, str))


NAMES = st.sampled_from(
    ["inside", "distance", "place", "startsWith", "contains", "matches", "size", "int", "double",
     "string", "type", "math.abs", "math.greatest", "math.ceil", "has", ".size", ".inside"]
)  # fmt: skip
VARIABLES = st.sampled_from(["v", "zone", "event", "math", "size", "package", "in", "__result__"])
OPERANDS = st.recursive(
    st.sampled_from(["event.pose.position", "event.header.frame_id", "zone", "v", "1", "1.0", "1.",
                     "'a'", r"'\q'", r"'\uD800'", r"b'\777'", r"'\x41'", "[]", "true", "math"]),
    lambda inner: (
        st.tuples(NAMES, st.lists(inner, max_size=2)).map(
            lambda each: f"{each[0]}({', '.join(each[1])})"
        )
        | st.tuples(inner, NAMES, st.lists(inner, max_size=2)).map(
            lambda each: f"{each[0]}.{each[1]}({', '.join(each[2])})"
        )
        | st.lists(inner, max_size=3).map(lambda each: f"[{', '.join(each)}]")
        | _binary(["==", "<", "in", "+", "||"], inner)
        | st.tuples(inner, inner, inner).map(lambda each: "({} ? {} : {})".format(*each))
        | st.tuples(inner, inner).map(lambda each: f"{each[0]}[{each[1]}]")
        | st.tuples(inner, st.sampled_from(["exists", "all", "map"]), VARIABLES, inner).map(
            lambda each: "{}.{}({}, {})".format(*each)
        )
    ),
    max_leaves=6,
)  # fmt: skip


@settings(max_examples=examples(400), deadline=None)
@given(OPERANDS)
def test_calls_that_python_accepts_google_s_cel_accepts(text):
    pytest.importorskip("cel_expr_python.cel", reason=NO_GOOGLE)
    message, definition = pose_stamped(Encoding.ROS1, x=1.0), DefinitionRegistry().find(POSE)
    asked = {"message": message, "definition": definition, "areas": [square()], "frames": ["map"]}
    try:
        found = in_python(text, **asked)
    except InputError:
        return
    expected = in_google(text, **asked)
    assert found is expected or (isinstance(found, str) and isinstance(expected, str))
