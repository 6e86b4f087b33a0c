"""Conditions: CEL's own truth over three values, and nothing but eflows."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import InputError
from rtron.messages import Condition
from rtron.messages.expressions.condition import MAX_CONDITION, MAX_DEPTH

NAMES = ("a", "b", "c")
STATES = (True, False, None)

texts = st.recursive(
    st.sampled_from([*NAMES, "true", "false"]),
    lambda inner: st.one_of(
        inner.map("!{}".format),
        inner.map("({})".format),
        st.tuples(inner, inner).map(" && ".join),
        st.tuples(inner, inner).map("||".join),
    ),
    max_leaves=8,
)


def bits(values):
    return {name: value for name, value in zip(NAMES, values, strict=True) if value is not None}


@given(text=texts)
def test_as_cel(text):
    cel = pytest.importorskip("cel_expr_python.cel", reason="no CEL on this machine")
    env = cel.NewEnv(variables=dict.fromkeys(NAMES, cel.Type.BOOL))
    expected, condition = env.compile(text), Condition(text, NAMES)
    for values in itertools.product(STATES, repeat=len(NAMES)):
        said = expected.eval(data=bits(values)).value()
        assert condition.holds(bits(values)) is (said if isinstance(said, bool) else None)


@given(text=texts)
def test_depends_on_its_names_only(text):
    condition = Condition(text, NAMES)
    for values in itertools.product(STATES, repeat=len(NAMES)):
        known = {name: value for name, value in bits(values).items() if name in condition.names}
        assert condition.holds(known) is condition.holds(bits(values))


@pytest.mark.parametrize(
    ("text", "names", "values"),
    [
        ("true", (), [True, True, True]),
        ("!true", (), [False, False, False]),
        ("a", "a", [True, False, None]),
        ("!a", "a", [False, True, None]),
        ("!!a", "a", [True, False, None]),
        ("a && false", "", [False, False, False]),
        ("a || true", "", [True, True, True]),
        ("a && true", "a", [True, False, None]),
        ("false || a", "a", [True, False, None]),
        ("a || !a", "a", [True, True, None]),
        ("\n( a )\t", "a", [True, False, None]),
    ],
)
def test_one_bit(text, names, values):
    condition = Condition(text, NAMES)
    assert condition.names == frozenset(names)
    assert condition.text == text
    found = [condition.holds(bits((value, None, None))) for value in STATES]
    assert found == values


@pytest.mark.parametrize(
    ("values", "both", "either"),
    [
        ((True, True), True, True),
        ((True, False), False, True),
        ((False, False), False, False),
        ((True, None), None, True),
        ((False, None), False, None),
        ((None, None), None, None),
    ],
)
def test_two_bits(values, both, either):
    for ordered in (values, values[::-1]):
        known = bits((*ordered, None))
        assert Condition("a && b", NAMES).holds(known) is both
        assert Condition("a || b", NAMES).holds(known) is either


def test_and_binds_before_or():
    known = {"a": True, "b": False, "c": False}
    assert Condition("a || b && c", NAMES).holds(known) is True
    assert Condition("(a || b) && c", NAMES).holds(known) is False
    assert Condition("!b || a && c", NAMES).names == {"a", "b", "c"}


@pytest.mark.parametrize(
    ("text", "said", "help"),
    [
        ("", "column 1 of the condition: it ends too early", "combine"),
        ("a &&", "column 5 of the condition: it ends too early", "combine"),
        ("a & b", "column 3 of the condition: '&' is not expected", "combine"),
        ("a zz", "column 3 of the condition: there is no eflow zz", None),
        ("(a", "column 3 of the condition: it ends too early", "combine"),
        ("a)", "column 2 of the condition: ')' is not expected", "combine"),
        ("persn", "column 1 of the condition: there is no eflow persn", "did you mean person?"),
        ("zzz", "there is no eflow zzz", "choose from person"),
        ("person == true", "column 8 of the condition: '=' is not expected", "combine"),
        ("1", "column 1 of the condition: '1' is not expected", "combine"),
        ("ä", "column 1 of the condition", None),
        ("\ud800", "column 1 of the condition", None),
        ("a\0b", "column 2", None),
    ],
)
def test_refused(text, said, help):
    names = NAMES if text[:1] in ("a", "(") else ("person",)
    with pytest.raises(InputError) as refused:
        Condition(text, names)
    assert said in str(refused.value)
    assert help is None or help in refused.value.help


def test_bound_of_length():
    Condition("a" + " " * (MAX_CONDITION - 1), NAMES)
    with pytest.raises(InputError, match="longer"):
        Condition("a" + " " * MAX_CONDITION, NAMES)


@pytest.mark.parametrize(("opening", "closing"), [("(", ")"), ("!", ""), ("!(", ")")])
def test_bound_of_depth(opening, closing):
    most = (MAX_DEPTH - 1) // len(opening)
    Condition(opening * most + "a" + closing * most, NAMES)
    for depth in (MAX_DEPTH, 1000):
        with pytest.raises(InputError, match="nested deeper"):
            Condition(opening * depth + "a" + closing * depth, NAMES)


def test_long_but_flat():
    assert Condition(" && ".join(["a"] * 800), NAMES).holds({"a": True}) is True


@given(text=st.text() | st.lists(st.sampled_from([*"ab!()&| ", "&&", "||", "true"])).map("".join))
def test_fuzz_condition(text):
    try:
        condition = Condition(text, NAMES)
    except InputError:
        return
    assert condition.holds({}) in (True, False, None)
