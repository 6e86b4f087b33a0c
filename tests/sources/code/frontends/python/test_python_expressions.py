"""Expressions of Python, lowered: each construct, and that its meaning stays."""

import operator
import warnings
from functools import reduce

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code import ir
from rtron.sources.code.frontends.python import lower_python
from rtron.sources.code.ir.references import ir_nodes

A, B, C = ir.Name("a"), ir.Name("b"), ir.Name("c")


def body(text):
    unit = lower_python("f.py", text.encode())
    assert unit.problems == ()
    return unit.body


def value(text):
    (statement,) = body(f"x = {text}\n")
    return statement.value


CASES = {
    "a": A,
    "'s'": ir.Const("s"),
    "'s' 't'": ir.Const("st"),
    "b's'": ir.Const(b"s"),
    "1": ir.Const(1),
    "1.5": ir.Const(1.5),
    "True": ir.Const(value=True),
    "None": ir.Const(None),
    "1j": ir.Opaque((), "1j"),
    "...": ir.Opaque((), "..."),
    "a.b": ir.Attr(A, "b"),
    "a.b.c": ir.Attr(ir.Attr(A, "b"), "c"),
    "a[b]": ir.Index(A, B),
    "a[b, c]": ir.Index(A, ir.SequenceExpr((B, C), "tuple")),
    "a[b:c]": ir.Index(A, ir.Call(ir.Name("slice"), (B, C, ir.Const(None)), (), 1)),
    "a[::b]": ir.Index(A, ir.Call(ir.Name("slice"), (ir.Const(None), ir.Const(None), B), (), 1)),
    "a[:]": ir.Index(A, ir.Call(ir.Name("slice"), (ir.Const(None),) * 3, (), 1)),
    "a()": ir.Call(A, (), (), 1),
    "a(b, *c)": ir.Call(A, (B, ir.Star(C)), (), 1),
    "a(b, k=c, **d)": ir.Call(A, (B,), (("k", C), ("**", ir.Name("d"))), 1),
    "a.b(c)": ir.Call(ir.Attr(A, "b"), (C,), (), 1),
    "not a": ir.Unary("not", A),
    "-a": ir.Unary("-", A),
    "+a": ir.Unary("+", A),
    "~a": ir.Unary("~", A),
    "a and b": ir.Logic("and", (A, B)),
    "a or b or c": ir.Logic("or", (A, B, C)),
    "a if b else c": ir.Conditional(B, A, C),
    "a < b < c": ir.Logic("and", (ir.Binary("<", A, B, 1), ir.Binary("<", B, C, 1))),
    "f'{a}/b'": ir.Concat((A, ir.Const("/b"))),
    "f'{a!s}'": ir.Concat((A,)),
    "f'{{}}'": ir.Concat((ir.Const("{}"),)),
    "[]": ir.SequenceExpr((), "list"),
    "[a, *b]": ir.SequenceExpr((A, ir.Star(B)), "list"),
    "(a,)": ir.SequenceExpr((A,), "tuple"),
    "{a, b}": ir.SequenceExpr((A, B), "set"),
    "{}": ir.MappingExpr(()),
    "{a: b, **c}": ir.MappingExpr(((A, B), (None, C))),
    "[a for a in b if c]": ir.Comprehension("list", A, ((A, B, (C,)),)),
    "{a for a in b}": ir.Comprehension("set", A, ((A, B, ()),)),
    "(a for b in c for a in b)": ir.Comprehension("generator", A, ((B, C, ()), (A, B, ()))),
    "{a: b for a, b in c}": ir.Comprehension(
        "dict", ir.SequenceExpr((A, B), "tuple"), ((ir.SequenceExpr((A, B), "tuple"), C, ()),)
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
    assert value(f"a {sign} b") == ir.Binary(sign, A, B, 1)


@pytest.mark.parametrize(
    ("text", "template"), [("{a!r}", "{!r:}"), ("{a!a}", "{!a:}"), ("{a:>3}", "{:>3}")]
)
def test_a_formatted_value_is_a_call_of_format(text, template):
    (part,) = value(f"f'{text}'").parts
    assert part == ir.Call(ir.Attr(ir.Const(template), "format"), (A,), (), 1)


def test_the_parts_of_a_format_are_arguments_too():
    (part,) = value("f'{a:0{b}d}'").parts
    assert part == ir.Call(ir.Attr(ir.Const("{:0{}d}"), "format"), (A, B), (), 1)


def test_a_call_knows_its_line():
    (first, second) = body("a(\n b)\nc()\n")
    assert (first.value.line, second.value.line) == (1, 3)


def test_a_lambda_is_a_function_with_defaults():
    assert value("lambda a, b=c, *d, e, **f: a") == ir.Lambda(
        ir.Function(
            name="<lambda>",
            file="f.py",
            line=1,
            params=(
                ir.Param("a"),
                ir.Param("b", default=C),
                ir.Param("d", kind="star"),
                ir.Param("e", kind="keyword"),
                ir.Param("f", kind="stars"),
            ),
            body=(ir.Return(A, 1),),
        )
    )


@pytest.mark.parametrize(
    "text", ["{}", "a and {}", "1 if a else {}", "[{} for a in a]", "a < a < {}"]
)
def test_a_walrus_assigns_where_it_stands(text):
    found = [
        node for node in ir_nodes(value(text.format("(b := c)"))) if isinstance(node, ir.AssignExpr)
    ]
    assert found == [ir.AssignExpr(B, C)]


def test_what_a_yield_gives_back_is_not_known():
    (function,) = body("def f():\n    a = yield b\n    yield\n    yield from c\n")
    given_back = ir.Opaque((), "yield b")
    assert function.definition.body == (
        ir.Yield(B),
        ir.Assign((A,), given_back, 2),
        ir.Yield(None),
        ir.Yield(ir.Star(C)),
    )


def test_await_is_what_is_awaited():
    (function,) = body("async def f():\n    await a()\n")
    assert function.definition.body == (ir.Evaluate(ir.Call(A, (), (), 2), 2),)


TWO = {"+": operator.add, "-": operator.sub, "*": operator.mul, "==": operator.eq}
TWO |= {"<": operator.lt, "<=": operator.le, "!=": operator.ne, "&": operator.and_}
ONE = {"-": operator.neg, "~": operator.invert, "not": operator.not_, "+": operator.pos}


DECIDED = {"and": lambda a, b: a and b, "or": lambda a, b: a or b}


def evaluated(node):  # noqa: PLR0911
    match node:
        case ir.Logic(word, operands):
            return reduce(DECIDED[word], map(evaluated, operands))
        case ir.Index(ir.SequenceExpr(items), ir.Const(place)):
            return evaluated(items[place])
        case ir.Call(_, (ir.Concat(parts),)):
            return len("".join(str(evaluated(part)) for part in parts))
        case ir.Binary(sign, left, right):
            return TWO[sign](evaluated(left), evaluated(right))
        case ir.Unary(sign, operand):
            return ONE[sign](evaluated(operand))
        case ir.Conditional(test, chosen, orelse):
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
