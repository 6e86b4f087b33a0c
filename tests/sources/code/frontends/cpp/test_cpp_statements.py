"""Statements of C++, lowered."""

import pytest
from cpp_cases import FOO, INT, A, B, C, initial, statement, statements, unit

from rtron.sources.code import ir

ONE, TWO = ir.Const(1), ir.Const(2)
DO_A, DO_B, DO_C = (ir.Evaluate(ir.Call(name, (), (), 2), 2) for name in (A, B, C))
STEP = ir.Assign((ir.Name("i"),), ir.Binary("+", ir.Name("i"), ONE, 2), 2)
VECTOR = ir.TypeRef("std::vector", (INT,))


@pytest.mark.parametrize(
    ("text", "declared"),
    [
        ("Foo x;", ir.Declare("x", FOO, line=2)),
        ("Foo x(a);", ir.Declare("x", FOO, ir.New(FOO, (A,), 2), line=2)),
        ("Foo x(a, n::b);", ir.Declare("x", FOO, ir.New(FOO, (A, ir.Name("n::b")), 2), line=2)),
        ("Foo x(a, 1);", ir.Declare("x", FOO, ir.New(FOO, (A, ONE), 2), line=2)),
        ('Foo x("~");', ir.Declare("x", FOO, ir.New(FOO, (ir.Const("~"),), 2), line=2)),
        ("Foo x(a.b);", ir.Declare("x", FOO, ir.New(FOO, (ir.Attr(A, "b"),), 2), line=2)),
        ("Foo x(a());", ir.Declare("x", FOO, ir.New(FOO, (ir.Call(A, (), (), 2),), 2), line=2)),
        ("Foo x(a(b));", ir.Declare("x", FOO, ir.New(FOO, (ir.Call(A, (B,), (), 2),), 2), line=2)),
        ("Foo x(a[1]);", ir.Declare("x", FOO, ir.New(FOO, (ir.Index(A, ONE),), 2), line=2)),
        ("Foo x(*a);", ir.Declare("x", FOO, ir.New(FOO, (A,), 2), line=2)),
        ("Foo x(&a);", ir.Declare("x", FOO, ir.New(FOO, (A,), 2), line=2)),
        ("Foo x{a};", ir.Declare("x", FOO, ir.New(FOO, (A,), 2, braced=True), line=2)),
        ("Foo x{};", ir.Declare("x", FOO, ir.New(FOO, (), 2, braced=True), line=2)),
        ("Foo x = a;", ir.Declare("x", FOO, A, line=2)),
        ("Foo x = {a, b};", ir.Declare("x", FOO, ir.SequenceExpr((A, B), ir.BRACES), line=2)),
        ("std::vector<int> x(a);", ir.Declare("x", VECTOR, ir.New(VECTOR, (A,), 2), line=2)),
        ("Foo* x = new Foo(1);",
         ir.Declare("x", FOO, ir.New(FOO, (ONE,), 2), pointer=True, line=2)),
        ("Foo* x(a);", ir.Declare("x", FOO, A, pointer=True, line=2)),
        ("Foo& x = a;", ir.Declare("x", FOO, A, reference=True, line=2)),
        ("const Foo& x(a);", ir.Declare("x", FOO, A, reference=True, line=2)),
        ("auto x = a;", ir.Declare("x", None, A, line=2)),
        ("auto x(a);", ir.Declare("x", None, A, line=2)),
        ("const auto& x = a;", ir.Declare("x", None, A, reference=True, line=2, constant=True)),
        ("const Foo* x = a;", ir.Declare("x", FOO, A, pointer=True, line=2)),
        ("const Foo* const* x = a;", ir.Declare("x", FOO, A, pointer=True, line=2)),
        ("Foo* const x = a;", ir.Declare("x", FOO, A, pointer=True, line=2)),
        ("const Foo* const x = a;", ir.Declare("x", FOO, A, pointer=True, line=2, constant=True)),
        ("constexpr const Foo* x = a;",
         ir.Declare("x", FOO, A, pointer=True, line=2, constant=True)),
        ("constexpr Foo& x = a;", ir.Declare("x", FOO, A, reference=True, line=2)),
        ("constexpr auto x = a;", ir.Declare("x", None, A, line=2, constant=True)),
        ("static int x = 1;", ir.Declare("x", INT, ONE, static=True, line=2)),
        ("unsigned  long x;", ir.Declare("x", ir.TypeRef("unsigned long"), line=2)),
        ("typename T::Foo x;", ir.Declare("x", ir.TypeRef("T::Foo"), line=2)),
        ("struct Foo x;", ir.Declare("x", FOO, line=2)),
        ("Foo x[4] = {a, b};",
         ir.Declare("x", ir.TypeRef("array", (FOO, ir.TypeRef("4"))),
                    ir.SequenceExpr((A, B), ir.BRACES), line=2)),
        ("T<Foo>::B x;", ir.Declare("x", ir.TypeRef("T::B", (FOO,)), line=2)),
        ("boost::shared_ptr<const n::Foo*> x;",
         ir.Declare("x", ir.TypeRef("boost::shared_ptr", (ir.TypeRef("n::Foo"),)), line=2)),
        ("__attribute__((unused)) Foo x;", ir.Declare("x", FOO, line=2)),
        ("auto [a, b] = c;", ir.Assign((ir.SequenceExpr((A, B), "tuple"),), C, 2)),
    ],
)  # fmt: skip
def test_variables(text, declared):
    assert statement(text) == declared


@pytest.mark.parametrize("text", ["Foo x();", "Foo x(int a);", "Foo x(Bar b);", "void x(a);", ";"])
def test_function_declarations_within_functions_are_dropped(text):
    assert statements(text) == ()


def test_one_declaration_declares_several():
    assert statements("int a = 1, *b = &c, c[2][3];") == (
        ir.Declare("a", INT, ONE, line=2),
        ir.Declare("b", INT, C, pointer=True, line=2),
        ir.Declare(
            "c",
            ir.TypeRef("array", (ir.TypeRef("array", (INT, ir.TypeRef("3"))), ir.TypeRef("2"))),
            line=2,
        ),
    )


def test_maps_are_lists_of_pairs():
    items = ((ir.Const("a"), ONE), (ir.Const("b"), TWO))
    pairs = ir.SequenceExpr(tuple(ir.SequenceExpr(item, ir.BRACES) for item in items), ir.BRACES)
    assert initial('std::map<std::string, int> m = {{"a", 1}, {"b", 2}};') == pairs


@pytest.mark.parametrize(
    ("text", "lowered"),
    [
        ("if (a) b();", (ir.If(A, (DO_B,), (), 2),)),
        ("if (a) { b(); } else c();", (ir.If(A, (DO_B,), (DO_C,), 2),)),
        ("if (a) {} else if (b) c();", (ir.If(A, (), (ir.If(B, (DO_C,), (), 2),), 2),)),
        ("if constexpr (a) b();", (ir.If(A, (DO_B,), (), 2),)),
        ("if (int a = 1; a) b();", (ir.Declare("a", INT, ONE, line=2), ir.If(A, (DO_B,), (), 2))),
        ("if (Foo* a = b) c();",
         (ir.Declare("a", FOO, B, pointer=True, line=2), ir.If(A, (DO_C,), (), 2))),
        ("if ((a = b)) c();", (ir.Assign((A,), B, 2), ir.If(A, (DO_C,), (), 2))),
        ("while (a) b();", (ir.While(A, (DO_B,), line=2),)),
        ("while (a = b) c();",
         (ir.Assign((A,), B, 2), ir.While(A, (DO_C,), (ir.Assign((A,), B, 2),), line=2))),
        ("do b(); while (a);", (ir.While(A, (DO_B,), first=True, line=2),)),
        ("for (;;) a();", (ir.While(ir.Const(value=True), (DO_A,), line=2),)),
        (
            "for (int i = 1; i < 2; ++i) a();",
            (
                ir.Declare("i", INT, ONE, line=2),
                ir.While(ir.Binary("<", ir.Name("i"), TWO, 2), (DO_A,), (STEP,), line=2),
            ),
        ),
        ("for (a = 1, b = 2; a; i++, c()) {}",
         (ir.Assign((A,), ONE, 2), ir.Assign((B,), TWO, 2), ir.While(A, (), (STEP, DO_C), line=2))),
        ("for (const auto& a : b) c();", (ir.ForEach(A, B, (DO_C,), 2, reference=True),)),
        ("for (auto c : b) {}", (ir.ForEach(C, B, (), 2),)),
        ("for (auto& [a, b] : c) {}",
         (ir.ForEach(ir.SequenceExpr((A, B), "tuple"), C, (), 2, reference=True),)),
        ("BOOST_FOREACH(Foo& a, b) { c(); }", (ir.ForEach(A, B, (DO_C,), 2, reference=True),)),
        ("Q_FOREACH(Foo a, b()) c();", (ir.ForEach(A, ir.Call(B, (), (), 2), (DO_C,), 2),)),
        ("while (a) { break; continue; }", (ir.While(A, (ir.Break(), ir.Continue()), line=2),)),
        ("return;", (ir.Return(None, 2),)),
        ("return a;", (ir.Return(A, 2),)),
        ("throw a;", (ir.Raise(A),)),
        ("throw;", (ir.Raise(None),)),
        ("try { a(); } catch (const n::E& e) { b(); } catch (...) { throw; }",
         (ir.Try((DO_A,), ((("n::E",), "e", (DO_B,)), (("...",), "", (ir.Raise(None),)))),)),
        ("here: a();", (DO_A,)),
        ("{ a(); { b(); } }", (DO_A, DO_B)),
        ("ALONE(a)\nb();", None),
    ],
)  # fmt: skip
def test_statements(text, lowered):
    found = statements(text)
    if lowered is None:
        assert [one.value.function.id for one in found] == ["ALONE", "b"]
    else:
        assert found == lowered


def is_(*values):
    tests = tuple(ir.Binary("==", A, ir.Const(value), 2) for value in values)
    return tests[0] if len(tests) == 1 else ir.Logic("or", tests)


@pytest.mark.parametrize(
    ("cases", "lowered"),
    [
        ("case 1: b(); break; default: c();", ir.If(is_(1), (DO_B,), (DO_C,), 2)),
        ("default: c(); break; case 1: b();", ir.If(is_(1), (DO_B,), (DO_C,), 2)),
        ("case 1: case 2: b(); break;", ir.If(is_(1, 2), (DO_B,), (), 2)),
        ("case 1: { b(); break; } case 2: c();",
         ir.If(is_(1), (DO_B,), (ir.If(is_(2), (DO_C,), (), 2),), 2)),
        ("case 1: b(); case 2: c(); break;",
         ir.If(is_(1), (DO_B, DO_C), (ir.If(is_(2), (DO_C,), (), 2),), 2)),
        ("case 1: return; case 2: c();",
         ir.If(is_(1), (ir.Return(None, 2),), (ir.If(is_(2), (DO_C,), (), 2),), 2)),
        ("case 1: b(); default: c();", ir.If(is_(1), (DO_B, DO_C), (DO_C,), 2)),
    ],
)  # fmt: skip
def test_a_switch_is_a_chain_of_ifs(cases, lowered):
    assert statement(f"switch (a) {{ {cases} }}") == lowered


def test_a_break_deep_in_a_case_leaves_the_switch_only():
    found = statement("switch (a) { case 1: if (b) break; c(); }")
    chain = ir.If(is_(1), (ir.If(B, (ir.Break(),), (), 2), DO_C), (), 2)
    assert found == ir.Breakable((chain,), 2)
    inner = statement("switch (a) { case 1: while (b) break; c(); }")
    assert inner == ir.If(is_(1), (ir.While(B, (ir.Break(),), line=2), DO_C), (), 2)


def test_what_is_switched_on_is_evaluated_once():
    kept, chain = statements("switch (a()) { default: c(); }")
    assert (kept, chain) == (ir.Declare("switch@2", None, ir.Call(A, (), (), 2), line=2), DO_C)


def test_a_jump_is_kept():
    assert statement("goto end;") == ir.Jump("end", 2)


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
