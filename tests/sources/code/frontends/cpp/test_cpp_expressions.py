"""Expressions of C++, lowered."""

import pytest
from cpp_cases import FOO, INT, A, B, C, expression, initial, statement, statements

from rtron.sources.code.ir import (
    BRACES,
    Assign,
    Attr,
    Binary,
    Call,
    Conditional,
    Const,
    Delete,
    Evaluate,
    Index,
    Lambda,
    Logic,
    Name,
    New,
    Opaque,
    Param,
    Return,
    SequenceExpr,
    TypeRef,
    Unary,
)

ONE = Const(1)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ('"a"', "a"),
        ('"a" "b"\n"c"', "abc"),
        ('L"a" u8"b"', "ab"),
        ('R"(a\\n")" "b"', 'a\\n"b'),
        ('R"x()")x"', ')"'),
        (r'"a\n\t\"\\\x41\101\u00e9"', 'a\n\t"\\AAé'),
        ("'c'", "c"),
        (r"'\n'", "\n"),
        ('"/*no comment*/ // nor this"', "/*no comment*/ // nor this"),
        ("12", 12),
        ("0x1Fu", 31),
        ("010", 8),
        ("0b101", 5),
        ("1'000'000ul", 1000000),
        ("1.5f", 1.5),
        (".5", 0.5),
        ("1e-3", 0.001),
        ("3.", 3.0),
        ("-2", -2),
        ("- 2.5", -2.5),
        ("true", True),
        ("false", False),
        ("nullptr", None),
        ("NULL", None),
        ('"x"s', "x"),
        ("5_m", 5),
    ],
)
def test_literals(text, value):
    found = expression(text)
    assert found == Const(value)
    assert type(found.value) is type(value)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a", A),
        ("this", Name("this")),
        ("ns::T::b", Name("ns::T::b")),
        ("::a", A),
        ("a.b", Attr(A, "b")),
        ("a->b", Attr(A, "b")),
        ("(*a).b", Attr(A, "b")),
        ("*a", A),
        ("&a", A),
        ("&C::m", Name("C::m")),
        ("a[b]", Index(A, B)),
        ("a[b][1]", Index(Index(A, B), ONE)),
        ("m[{a, b}]", Index(Name("m"), SequenceExpr((A, B), BRACES))),
        ("(a)", A),
        ("static_cast<int>(a)", A),
        ("boost::shared_ptr<Foo>(a)", Call(Name("boost::shared_ptr", (FOO,)), (A,), (), 2)),
        ("(double)a", A),
        ("int(a)", Call(Name("int"), (A,), (), 2)),
        ("a()", Call(A, (), (), 2)),
        ("a(b, 1)", Call(A, (B, ONE), (), 2)),
        ("a.f<int>(1)", Call(Attr(A, "f", (INT,)), (ONE,), (), 2)),
        ("a.template f<int>(1)", Call(Attr(A, "f", (INT,)), (ONE,), (), 2)),
        ("n::f<Foo, 3>(a)", Call(Name("n::f", (FOO, TypeRef("3"))), (A,), (), 2)),
        ("T<Foo>::make(a)", Call(Name("T::make", (FOO,)), (A,), (), 2)),
        ("std::move(a)", Call(Name("std::move"), (A,), (), 2)),
        ("Base::run()", Call(Name("Base::run"), (), (), 2)),
        ("new Foo(1)", New(FOO, (ONE,), 2)),
        ("new Foo", New(FOO, (), 2)),
        ("new n::T<int>{a}", New(TypeRef("n::T", (INT,)), (A,), 2, braced=True)),
        ("new Foo[3]", New(TypeRef("array", (FOO, TypeRef("3"))), (), 2)),
        ("Foo{1, a}", New(FOO, (ONE, A), 2, braced=True)),
        ("a + b * c", Binary("+", A, Binary("*", B, C, 2), 2)),
        ("a - b - c", Binary("-", Binary("-", A, B, 2), C, 2)),
        ("a << b << c", Binary("<<", Binary("<<", A, B, 2), C, 2)),
        ("a >= b", Binary(">=", A, B, 2)),
        ("a bitand b", Binary("&", A, B, 2)),
        ("a && b && c", Logic("and", (A, B, C))),
        ("a || b && c", Logic("or", (A, Logic("and", (B, C))))),
        ("!a", Unary("not", A)),
        ("not a", Unary("not", A)),
        ("~a", Unary("~", A)),
        ("-a", Unary("-", A)),
        ("a ? b : c", Conditional(A, B, C)),
        ("sizeof(a)", Opaque((), "sizeof(a)")),
        (
            'f({{"a", 1}})',
            Call(
                Name("f"),
                (SequenceExpr((SequenceExpr((Const("a"), ONE), BRACES),), BRACES),),
                (),
                2,
            ),
        ),
        (
            "boost::bind(&C::m, this, _1)",
            Call(Name("boost::bind"), (Name("C::m"), Name("this"), Name("_1")), (), 2),
        ),
    ],
)
def test_expressions(text, value):
    assert expression(text) == value


def test_a_lambda_is_a_function_without_a_name():
    value = initial("auto g = [&, a](const Foo& x, int& y) -> int { return y; };")
    assert isinstance(value, Lambda)
    x, y = Param("x", FOO, constant=True), Param("y", INT, reference=True)
    assert value.function.params == (x, y)
    assert (value.function.returns, value.function.name) == (INT, "")
    assert value.function.body == (Return(Name("y"), 2),)
    assert value.copies == ("a",)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a = b", Assign((A,), B, 2)),
        ("a = b = c", Assign((A, B), C, 2)),
        ("a += b", Assign((A,), Binary("+", A, B, 2), 2)),
        ("a <<= 1", Assign((A,), Binary("<<", A, ONE, 2), 2)),
        ("a++", Assign((A,), Binary("+", A, ONE, 2), 2)),
        ("--a", Assign((A,), Binary("-", A, ONE, 2), 2)),
        ("a.b[1] = c", Assign((Index(Attr(A, "b"), ONE),), C, 2)),
        ("*a = b", Assign((A,), B, 2)),
        ("delete a", Delete((A,))),
        ("delete[] a", Delete((A,))),
    ],
)
def test_expressions_that_are_statements(text, value):
    assert statement(f"{text};") == value


def test_what_an_expression_changes_stands_before_its_statement():
    add = Assign((B,), Binary("+", B, ONE, 2), 2)
    old = Binary("-", B, ONE, 2)
    assert statements("a[b++] = c;") == (add, Assign((Index(A, old),), C, 2))
    assert statements("f(++b);") == (add, Evaluate(Call(Name("f"), (B,), (), 2), 2))
    assert statements("f(a = b);") == (
        Assign((A,), B, 2),
        Evaluate(Call(Name("f"), (A,), (), 2), 2),
    )
    assert statements("a, b;") == (Evaluate(A, 2), Evaluate(B, 2))


def test_what_may_not_be_evaluated_is_not_put_before():
    assert expression("a && (b = c)") == Logic("and", (A, Opaque((B, C), "b = c")))


def test_a_chain_longer_than_the_bound_keeps_its_last_operands():
    found = expression("a" + " << f(b)" * 500)
    depth = 0
    while isinstance(found, Binary):
        found, depth = found.left, depth + 1
    assert depth == 45
    assert isinstance(found, Opaque)
    assert found.parts[-1] == Call(Name("f"), (B,), (), 2)
    assert len(found.parts) == 500 - 45 + 1


@pytest.mark.parametrize(
    ("written", "type"),
    [
        ("Foo<A>", TypeRef("Foo", (TypeRef("A"),))),
        ("n::Foo<A>", TypeRef("n::Foo", (TypeRef("A"),))),
        ("Foo<A<int>>", TypeRef("Foo", (TypeRef("A", (INT,)),))),
        ("Foo<A>, 3", TypeRef("Foo", (TypeRef("A"),))),
    ],
)
@pytest.mark.parametrize("outer", ["f", "n::f"])
def test_a_template_argument_is_a_type_wherever_the_call_stands(written, type, outer):
    """The grammar takes it for a function in the first argument of `n::f`."""
    (call,) = expression(f"{outer}(std::make_shared<{written}>(a))").args
    assert call.function.types[0] == type
