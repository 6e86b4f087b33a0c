"""Expressions of Python, lowered: each construct, and that its meaning stays."""

import operator
import warnings
from functools import reduce

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code.frontends.python import lower_python
from rtron.sources.code.ir import (
    Assign,
    AssignExpr,
    Attr,
    Binary,
    Call,
    Comprehension,
    Concat,
    Conditional,
    Const,
    Evaluate,
    Function,
    Index,
    Lambda,
    Logic,
    MappingExpr,
    Name,
    Opaque,
    Param,
    Return,
    SequenceExpr,
    Star,
    Unary,
    Yield,
)
from rtron.sources.code.ir.references import ir_nodes

A, B, C = Name("a"), Name("b"), Name("c")


def body(text):
    unit = lower_python("f.py", text.encode())
    assert unit.problems == ()
    return unit.body


def value(text):
    (statement,) = body(f"x = {text}\n")
    return statement.value


CASES = {
    "a": A,
    "'s'": Const("s"),
    "'s' 't'": Const("st"),
    "b's'": Const(b"s"),
    "1": Const(1),
    "1.5": Const(1.5),
    "True": Const(value=True),
    "None": Const(None),
    "1j": Opaque((), "1j"),
    "...": Opaque((), "..."),
    "a.b": Attr(A, "b"),
    "a.b.c": Attr(Attr(A, "b"), "c"),
    "a[b]": Index(A, B),
    "a[b, c]": Index(A, SequenceExpr((B, C), "tuple")),
    "a[b:c]": Index(A, Call(Name("slice"), (B, C, Const(None)), (), 1)),
    "a[::b]": Index(A, Call(Name("slice"), (Const(None), Const(None), B), (), 1)),
    "a[:]": Index(A, Call(Name("slice"), (Const(None),) * 3, (), 1)),
    "a()": Call(A, (), (), 1),
    "a(b, *c)": Call(A, (B, Star(C)), (), 1),
    "a(b, k=c, **d)": Call(A, (B,), (("k", C), ("**", Name("d"))), 1),
    "a.b(c)": Call(Attr(A, "b"), (C,), (), 1),
    "not a": Unary("not", A),
    "-a": Unary("-", A),
    "+a": Unary("+", A),
    "~a": Unary("~", A),
    "a and b": Logic("and", (A, B)),
    "a or b or c": Logic("or", (A, B, C)),
    "a if b else c": Conditional(B, A, C),
    "a < b < c": Logic("and", (Binary("<", A, B, 1), Binary("<", B, C, 1))),
    "f'{a}/b'": Concat((A, Const("/b"))),
    "f'{a!s}'": Concat((A,)),
    "f'{{}}'": Concat((Const("{}"),)),
    "[]": SequenceExpr((), "list"),
    "[a, *b]": SequenceExpr((A, Star(B)), "list"),
    "(a,)": SequenceExpr((A,), "tuple"),
    "{a, b}": SequenceExpr((A, B), "set"),
    "{}": MappingExpr(()),
    "{a: b, **c}": MappingExpr(((A, B), (None, C))),
    "[a for a in b if c]": Comprehension("list", A, ((A, B, (C,)),)),
    "{a for a in b}": Comprehension("set", A, ((A, B, ()),)),
    "(a for b in c for a in b)": Comprehension("generator", A, ((B, C, ()), (A, B, ()))),
    "{a: b for a, b in c}": Comprehension(
        "dict", SequenceExpr((A, B), "tuple"), ((SequenceExpr((A, B), "tuple"), C, ()),)
    ),
}


@pytest.mark.parametrize("text", CASES)
def test_each_construct_has_its_counterpart(text):
    assert value(text) == CASES[text]


SIGNS = [
    "+",
    "-",
    "*",
    "/",
    "//",
    "%",
    "**",
    "@",
    "<<",
    ">>",
    "&",
    "|",
    "^",
    "==",
    "!=",
    "<",
    "<=",
    ">",
    ">=",
    "is",
    "in",
]


@pytest.mark.parametrize("sign", [*SIGNS, "is not", "not in"])
def test_an_operator_is_spelled_as_in_python(sign):
    assert value(f"a {sign} b") == Binary(sign, A, B, 1)


@pytest.mark.parametrize(
    ("text", "template"), [("{a!r}", "{!r:}"), ("{a!a}", "{!a:}"), ("{a:>3}", "{:>3}")]
)
def test_a_formatted_value_is_a_call_of_format(text, template):
    (part,) = value(f"f'{text}'").parts
    assert part == Call(Attr(Const(template), "format"), (A,), (), 1)


def test_the_parts_of_a_format_are_arguments_too():
    (part,) = value("f'{a:0{b}d}'").parts
    assert part == Call(Attr(Const("{:0{}d}"), "format"), (A, B), (), 1)


def test_a_call_knows_its_line():
    (first, second) = body("a(\n b)\nc()\n")
    assert (first.value.line, second.value.line) == (1, 3)


def test_a_lambda_is_a_function_with_defaults():
    assert value("lambda a, b=c, *d, e, **f: a") == Lambda(
        Function(
            name="<lambda>",
            file="f.py",
            line=1,
            params=(
                Param("a"),
                Param("b", default=C),
                Param("d", kind="star"),
                Param("e", kind="keyword"),
                Param("f", kind="stars"),
            ),
            body=(Return(A, 1),),
        )
    )


@pytest.mark.parametrize(
    "text", ["{}", "a and {}", "1 if a else {}", "[{} for a in a]", "a < a < {}"]
)
def test_a_walrus_assigns_where_it_stands(text):
    found = [
        node for node in ir_nodes(value(text.format("(b := c)"))) if isinstance(node, AssignExpr)
    ]
    assert found == [AssignExpr(B, C)]


def test_what_a_yield_gives_back_is_not_known():
    (function,) = body("def f():\n    a = yield b\n    yield\n    yield from c\n")
    given_back = Opaque((), "yield b")
    assert function.definition.body == (
        Yield(B),
        Assign((A,), given_back, 2),
        Yield(None),
        Yield(Star(C)),
    )


def test_await_is_what_is_awaited():
    (function,) = body("async def f():\n    await a()\n")
    assert function.definition.body == (Evaluate(Call(A, (), (), 2), 2),)


TWO = {"+": operator.add, "-": operator.sub, "*": operator.mul, "==": operator.eq}
TWO |= {"<": operator.lt, "<=": operator.le, "!=": operator.ne, "&": operator.and_}
ONE = {"-": operator.neg, "~": operator.invert, "not": operator.not_, "+": operator.pos}


DECIDED = {"and": lambda a, b: a and b, "or": lambda a, b: a or b}


def evaluated(node):  # noqa: PLR0911
    match node:
        case Logic(word, operands):
            return reduce(DECIDED[word], map(evaluated, operands))
        case Index(SequenceExpr(items), Const(place)):
            return evaluated(items[place])
        case Call(_, (Concat(parts),)):
            return len("".join(str(evaluated(part)) for part in parts))
        case Binary(sign, left, right):
            return TWO[sign](evaluated(left), evaluated(right))
        case Unary(sign, operand):
            return ONE[sign](evaluated(operand))
        case Conditional(test, chosen, orelse):
            return evaluated(chosen if evaluated(test) else orelse)
    return node.value


def grown(inner):
    pairs = st.tuples(inner, st.sampled_from(sorted(TWO)), inner)
    return st.one_of(
        pairs.map("({0[0]} {0[1]} {0[2]})".format),
        st.tuples(inner, inner, inner).map("({0[0]} < {0[1]} <= {0[2]})".format),
        st.tuples(inner, inner).map("({0[0]} and {0[1]})".format),
        st.tuples(inner, inner).map("({0[0]} or {0[1]})".format),
        st.tuples(inner, inner, inner).map("({0[0]} if {0[1]} else {0[2]})".format),
        st.tuples(inner, inner).map("[{0[0]}, {0[1]}][1]".format),
        st.tuples(st.integers(), st.integers()).map("len(f'{{{0[0]}}}/{{{0[1]}}}')".format),
        st.tuples(st.sampled_from(sorted(ONE)), inner).map("({0[0]} {0[1]})".format),
    )


@given(st.recursive(st.integers(0, 9).map(str), grown, max_leaves=12))
def test_an_expression_keeps_its_meaning(text):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert evaluated(value(text)) == eval(text)
