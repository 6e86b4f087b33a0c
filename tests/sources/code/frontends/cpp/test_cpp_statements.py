"""Statements and expressions of C++ that are long, lowered; the others are in `lowered/`."""

from cpp_cases import A, B, C, expression, statement, unit

from rtron.sources.code import ir

DO_C = ir.Evaluate(ir.Call(C, (), (), 2), 2)


def test_a_chain_longer_than_the_bound_keeps_its_last_operands():
    found = expression("a" + " << f(b)" * 500)
    depth = 0
    while isinstance(found, ir.Binary):
        found, depth = found.left, depth + 1
    assert depth == 45
    assert isinstance(found, ir.Opaque)
    assert found.parts[-1] == ir.Call(ir.Name("f"), (B,), (), 2)
    assert len(found.parts) == 500 - 45 + 1


def test_a_long_switch_is_parted_and_stays_flat():
    text = " ".join(f"case {n}: f{n}(); break;" for n in range(200))
    found, depth = statement(f"switch (a) {{ {text} default: c(); }}"), 0
    assert found.test == ir.Binary(
        "in", A, ir.SequenceExpr(tuple(ir.Const(n) for n in range(100))), 2
    )
    while isinstance(found, ir.If):
        found, depth = found.orelse[-1], depth + 1
    assert found == DO_C
    assert depth < 30


def test_lines_are_those_of_the_file():
    (function,) = unit("/* a\n*/\n#define X 1\nvoid f() // b\n{\n\n  a();\n}\n").functions
    assert (function.line, function.body[0].line) == (4, 7)
