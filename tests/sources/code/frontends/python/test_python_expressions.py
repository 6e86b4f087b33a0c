"""Expressions of Python keep their meaning as they are lowered."""

import operator
import warnings
from functools import reduce

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code import ir
from rtron.sources.code.frontends.python import lower_python
from rtron.sources.code.ir.references import ir_nodes


def body(text):
    unit = lower_python("f.py", text.encode())
    assert unit.problems == ()
    return unit.body


def test_a_unit_knows_its_file_and_language():
    unit = lower_python("f.py", b"")
    assert (unit.file, unit.language, unit.body) == ("f.py", ir.SourceLanguage.PYTHON, ())


@pytest.mark.parametrize(
    ("pattern", "names"),
    [
        ("[b, *c]", {"b", "c"}),
        ("{'k': b, **c}", {"b", "c"}),
        ("K(b, x=c)", {"b", "c"}),
        ("(1 | 2) as b", {"b"}),
        ("b", {"b"}),
        ("b if b", {"b"}),
    ],
)
def test_a_case_binds_the_names_of_its_pattern(pattern, names):
    (_, chain) = body(f"match a:\n case {pattern}: pass\n")
    bound = (node for node in ir_nodes(chain.test) if isinstance(node, ir.AssignExpr))
    assert {node.target.id for node in bound} == names


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
        (statement,) = body(f"x = {text}\n")
        assert evaluated(statement.value) == eval(text)
