"""Statements of C++, lowered."""

import pytest
from cpp_cases import FOO, INT, A, B, C, initial, statement, statements, unit

from rtron.sources.code.ir import (
    BRACES,
    Assign,
    Attr,
    Binary,
    Break,
    Breakable,
    Call,
    Const,
    Continue,
    Declare,
    Evaluate,
    ForEach,
    If,
    Index,
    Jump,
    Logic,
    Name,
    New,
    Raise,
    Return,
    SequenceExpr,
    Try,
    TypeRef,
    While,
)

ONE, TWO = Const(1), Const(2)
DO_A, DO_B, DO_C = (Evaluate(Call(name, (), (), 2), 2) for name in (A, B, C))
STEP = Assign((Name("i"),), Binary("+", Name("i"), ONE, 2), 2)
VECTOR = TypeRef("std::vector", (INT,))


@pytest.mark.parametrize(
    ("text", "declared"),
    [
        ("Foo x;", Declare("x", FOO, line=2)),
        ("Foo x(a);", Declare("x", FOO, New(FOO, (A,), 2), line=2)),
        ("Foo x(a, n::b);", Declare("x", FOO, New(FOO, (A, Name("n::b")), 2), line=2)),
        ("Foo x(a, 1);", Declare("x", FOO, New(FOO, (A, ONE), 2), line=2)),
        ('Foo x("~");', Declare("x", FOO, New(FOO, (Const("~"),), 2), line=2)),
        ("Foo x(a.b);", Declare("x", FOO, New(FOO, (Attr(A, "b"),), 2), line=2)),
        ("Foo x(a());", Declare("x", FOO, New(FOO, (Call(A, (), (), 2),), 2), line=2)),
        ("Foo x(a(b));", Declare("x", FOO, New(FOO, (Call(A, (B,), (), 2),), 2), line=2)),
        ("Foo x(a[1]);", Declare("x", FOO, New(FOO, (Index(A, ONE),), 2), line=2)),
        ("Foo x(*a);", Declare("x", FOO, New(FOO, (A,), 2), line=2)),
        ("Foo x(&a);", Declare("x", FOO, New(FOO, (A,), 2), line=2)),
        ("Foo x{a};", Declare("x", FOO, New(FOO, (A,), 2, braced=True), line=2)),
        ("Foo x{};", Declare("x", FOO, New(FOO, (), 2, braced=True), line=2)),
        ("Foo x = a;", Declare("x", FOO, A, line=2)),
        ("Foo x = {a, b};", Declare("x", FOO, SequenceExpr((A, B), BRACES), line=2)),
        ("std::vector<int> x(a);", Declare("x", VECTOR, New(VECTOR, (A,), 2), line=2)),
        ("Foo* x = new Foo(1);", Declare("x", FOO, New(FOO, (ONE,), 2), pointer=True, line=2)),
        ("Foo* x(a);", Declare("x", FOO, A, pointer=True, line=2)),
        ("Foo& x = a;", Declare("x", FOO, A, reference=True, line=2)),
        ("const Foo& x(a);", Declare("x", FOO, A, reference=True, line=2)),
        ("auto x = a;", Declare("x", None, A, line=2)),
        ("auto x(a);", Declare("x", None, A, line=2)),
        ("const auto& x = a;", Declare("x", None, A, reference=True, line=2, constant=True)),
        ("const Foo* x = a;", Declare("x", FOO, A, pointer=True, line=2)),
        ("const Foo* const* x = a;", Declare("x", FOO, A, pointer=True, line=2)),
        ("Foo* const x = a;", Declare("x", FOO, A, pointer=True, line=2)),
        ("const Foo* const x = a;", Declare("x", FOO, A, pointer=True, line=2, constant=True)),
        ("constexpr const Foo* x = a;", Declare("x", FOO, A, pointer=True, line=2, constant=True)),
        ("constexpr Foo& x = a;", Declare("x", FOO, A, reference=True, line=2)),
        ("constexpr auto x = a;", Declare("x", None, A, line=2, constant=True)),
        ("static int x = 1;", Declare("x", INT, ONE, static=True, line=2)),
        ("unsigned  long x;", Declare("x", TypeRef("unsigned long"), line=2)),
        ("typename T::Foo x;", Declare("x", TypeRef("T::Foo"), line=2)),
        ("struct Foo x;", Declare("x", FOO, line=2)),
        ("Foo x[4] = {a, b};",
         Declare("x", TypeRef("array", (FOO, TypeRef("4"))), SequenceExpr((A, B), BRACES), line=2)),
        ("T<Foo>::B x;", Declare("x", TypeRef("T::B", (FOO,)), line=2)),
        ("boost::shared_ptr<const n::Foo*> x;",
         Declare("x", TypeRef("boost::shared_ptr", (TypeRef("n::Foo"),)), line=2)),
        ("__attribute__((unused)) Foo x;", Declare("x", FOO, line=2)),
        ("auto [a, b] = c;", Assign((SequenceExpr((A, B), "tuple"),), C, 2)),
    ],
)  # fmt: skip
def test_variables(text, declared):
    assert statement(text) == declared


@pytest.mark.parametrize("text", ["Foo x();", "Foo x(int a);", "Foo x(Bar b);", "void x(a);", ";"])
def test_function_declarations_within_functions_are_dropped(text):
    assert statements(text) == ()


def test_one_declaration_declares_several():
    assert statements("int a = 1, *b = &c, c[2][3];") == (
        Declare("a", INT, ONE, line=2),
        Declare("b", INT, C, pointer=True, line=2),
        Declare(
            "c", TypeRef("array", (TypeRef("array", (INT, TypeRef("3"))), TypeRef("2"))), line=2
        ),
    )


def test_maps_are_lists_of_pairs():
    items = ((Const("a"), ONE), (Const("b"), TWO))
    pairs = SequenceExpr(tuple(SequenceExpr(item, BRACES) for item in items), BRACES)
    assert initial('std::map<std::string, int> m = {{"a", 1}, {"b", 2}};') == pairs


@pytest.mark.parametrize(
    ("text", "lowered"),
    [
        ("if (a) b();", (If(A, (DO_B,), (), 2),)),
        ("if (a) { b(); } else c();", (If(A, (DO_B,), (DO_C,), 2),)),
        ("if (a) {} else if (b) c();", (If(A, (), (If(B, (DO_C,), (), 2),), 2),)),
        ("if constexpr (a) b();", (If(A, (DO_B,), (), 2),)),
        ("if (int a = 1; a) b();", (Declare("a", INT, ONE, line=2), If(A, (DO_B,), (), 2))),
        ("if (Foo* a = b) c();",
         (Declare("a", FOO, B, pointer=True, line=2), If(A, (DO_C,), (), 2))),
        ("if ((a = b)) c();", (Assign((A,), B, 2), If(A, (DO_C,), (), 2))),
        ("while (a) b();", (While(A, (DO_B,), line=2),)),
        ("while (a = b) c();",
         (Assign((A,), B, 2), While(A, (DO_C,), (Assign((A,), B, 2),), line=2))),
        ("do b(); while (a);", (While(A, (DO_B,), first=True, line=2),)),
        ("for (;;) a();", (While(Const(value=True), (DO_A,), line=2),)),
        (
            "for (int i = 1; i < 2; ++i) a();",
            (
                Declare("i", INT, ONE, line=2),
                While(Binary("<", Name("i"), TWO, 2), (DO_A,), (STEP,), line=2),
            ),
        ),
        ("for (a = 1, b = 2; a; i++, c()) {}",
         (Assign((A,), ONE, 2), Assign((B,), TWO, 2), While(A, (), (STEP, DO_C), line=2))),
        ("for (const auto& a : b) c();", (ForEach(A, B, (DO_C,), 2, reference=True),)),
        ("for (auto c : b) {}", (ForEach(C, B, (), 2),)),
        ("for (auto& [a, b] : c) {}",
         (ForEach(SequenceExpr((A, B), "tuple"), C, (), 2, reference=True),)),
        ("BOOST_FOREACH(Foo& a, b) { c(); }", (ForEach(A, B, (DO_C,), 2, reference=True),)),
        ("Q_FOREACH(Foo a, b()) c();", (ForEach(A, Call(B, (), (), 2), (DO_C,), 2),)),
        ("while (a) { break; continue; }", (While(A, (Break(), Continue()), line=2),)),
        ("return;", (Return(None, 2),)),
        ("return a;", (Return(A, 2),)),
        ("throw a;", (Raise(A),)),
        ("throw;", (Raise(None),)),
        ("try { a(); } catch (const n::E& e) { b(); } catch (...) { throw; }",
         (Try((DO_A,), ((("n::E",), "e", (DO_B,)), (("...",), "", (Raise(None),)))),)),
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
    tests = tuple(Binary("==", A, Const(value), 2) for value in values)
    return tests[0] if len(tests) == 1 else Logic("or", tests)


@pytest.mark.parametrize(
    ("cases", "lowered"),
    [
        ("case 1: b(); break; default: c();", If(is_(1), (DO_B,), (DO_C,), 2)),
        ("default: c(); break; case 1: b();", If(is_(1), (DO_B,), (DO_C,), 2)),
        ("case 1: case 2: b(); break;", If(is_(1, 2), (DO_B,), (), 2)),
        ("case 1: { b(); break; } case 2: c();",
         If(is_(1), (DO_B,), (If(is_(2), (DO_C,), (), 2),), 2)),
        ("case 1: b(); case 2: c(); break;",
         If(is_(1), (DO_B, DO_C), (If(is_(2), (DO_C,), (), 2),), 2)),
        ("case 1: return; case 2: c();",
         If(is_(1), (Return(None, 2),), (If(is_(2), (DO_C,), (), 2),), 2)),
        ("case 1: b(); default: c();", If(is_(1), (DO_B, DO_C), (DO_C,), 2)),
    ],
)  # fmt: skip
def test_a_switch_is_a_chain_of_ifs(cases, lowered):
    assert statement(f"switch (a) {{ {cases} }}") == lowered


def test_a_break_deep_in_a_case_leaves_the_switch_only():
    found = statement("switch (a) { case 1: if (b) break; c(); }")
    chain = If(is_(1), (If(B, (Break(),), (), 2), DO_C), (), 2)
    assert found == Breakable((chain,), 2)
    inner = statement("switch (a) { case 1: while (b) break; c(); }")
    assert inner == If(is_(1), (While(B, (Break(),), line=2), DO_C), (), 2)


def test_what_is_switched_on_is_evaluated_once():
    kept, chain = statements("switch (a()) { default: c(); }")
    assert (kept, chain) == (Declare("switch@2", None, Call(A, (), (), 2), line=2), DO_C)


def test_a_jump_is_kept():
    assert statement("goto end;") == Jump("end", 2)


def test_a_long_switch_is_parted_and_stays_flat():
    text = " ".join(f"case {n}: f{n}(); break;" for n in range(200))
    found, depth = statement(f"switch (a) {{ {text} default: c(); }}"), 0
    assert found.test == Binary("in", A, SequenceExpr(tuple(Const(n) for n in range(100))), 2)
    while isinstance(found, If):
        found, depth = found.orelse[-1], depth + 1
    assert found == DO_C
    assert depth < 30


def test_lines_are_those_of_the_file():
    (function,) = unit("/* a\n*/\n#define X 1\nvoid f() // b\n{\n\n  a();\n}\n").functions
    assert (function.line, function.body[0].line) == (4, 7)
