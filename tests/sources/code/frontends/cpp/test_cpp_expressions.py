"""Expressions of C++, lowered."""

import pytest
from cpp_cases import FOO, INT, A, B, C, expression, initial, statement, statements

from rtron.sources.code import ir

ONE = ir.Const(1)


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
    assert found == ir.Const(value)
    assert type(found.value) is type(value)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a", A),
        ("this", ir.Name("this")),
        ("ns::T::b", ir.Name("ns::T::b")),
        ("::a", A),
        ("a.b", ir.Attr(A, "b")),
        ("a->b", ir.Attr(A, "b")),
        ("(*a).b", ir.Attr(A, "b")),
        ("*a", A),
        ("&a", A),
        ("&C::m", ir.Name("C::m")),
        ("a[b]", ir.Index(A, B)),
        ("a[b][1]", ir.Index(ir.Index(A, B), ONE)),
        ("m[{a, b}]", ir.Index(ir.Name("m"), ir.SequenceExpr((A, B), ir.BRACES))),
        ("(a)", A),
        ("static_cast<int>(a)", A),
        ("boost::shared_ptr<Foo>(a)", ir.Call(ir.Name("boost::shared_ptr", (FOO,)), (A,), (), 2)),
        ("(double)a", A),
        ("int(a)", ir.Call(ir.Name("int"), (A,), (), 2)),
        ("a()", ir.Call(A, (), (), 2)),
        ("a(b, 1)", ir.Call(A, (B, ONE), (), 2)),
        ("a.f<int>(1)", ir.Call(ir.Attr(A, "f", (INT,)), (ONE,), (), 2)),
        ("a.template f<int>(1)", ir.Call(ir.Attr(A, "f", (INT,)), (ONE,), (), 2)),
        ("n::f<Foo, 3>(a)", ir.Call(ir.Name("n::f", (FOO, ir.TypeRef("3"))), (A,), (), 2)),
        ("T<Foo>::make(a)", ir.Call(ir.Name("T::make", (FOO,)), (A,), (), 2)),
        ("std::move(a)", ir.Call(ir.Name("std::move"), (A,), (), 2)),
        ("Base::run()", ir.Call(ir.Name("Base::run"), (), (), 2)),
        ("new Foo(1)", ir.New(FOO, (ONE,), 2)),
        ("new Foo", ir.New(FOO, (), 2)),
        ("new n::T<int>{a}", ir.New(ir.TypeRef("n::T", (INT,)), (A,), 2, braced=True)),
        ("new Foo[3]", ir.New(ir.TypeRef("array", (FOO, ir.TypeRef("3"))), (), 2)),
        ("Foo{1, a}", ir.New(FOO, (ONE, A), 2, braced=True)),
        ("a + b * c", ir.Binary("+", A, ir.Binary("*", B, C, 2), 2)),
        ("a - b - c", ir.Binary("-", ir.Binary("-", A, B, 2), C, 2)),
        ("a << b << c", ir.Binary("<<", ir.Binary("<<", A, B, 2), C, 2)),
        ("a >= b", ir.Binary(">=", A, B, 2)),
        ("a bitand b", ir.Binary("&", A, B, 2)),
        ("a && b && c", ir.Logic("and", (A, B, C))),
        ("a || b && c", ir.Logic("or", (A, ir.Logic("and", (B, C))))),
        ("!a", ir.Unary("not", A)),
        ("not a", ir.Unary("not", A)),
        ("~a", ir.Unary("~", A)),
        ("-a", ir.Unary("-", A)),
        ("a ? b : c", ir.Conditional(A, B, C)),
        ("sizeof(a)", ir.Opaque((), "sizeof(a)")),
        (
            'f({{"a", 1}})',
            ir.Call(
                ir.Name("f"),
                (ir.SequenceExpr((ir.SequenceExpr((ir.Const("a"), ONE), ir.BRACES),), ir.BRACES),),
                (),
                2,
            ),
        ),
        (
            "boost::bind(&C::m, this, _1)",
            ir.Call(
                ir.Name("boost::bind"), (ir.Name("C::m"), ir.Name("this"), ir.Name("_1")), (), 2
            ),
        ),
    ],
)
def test_expressions(text, value):
    assert expression(text) == value


def test_a_lambda_is_a_function_without_a_name():
    value = initial("auto g = [&, a](const Foo& x, int& y) -> int { return y; };")
    assert isinstance(value, ir.Lambda)
    x, y = ir.Param("x", FOO, constant=True), ir.Param("y", INT, reference=True)
    assert value.function.params == (x, y)
    assert (value.function.returns, value.function.name) == (INT, "")
    assert value.function.body == (ir.Return(ir.Name("y"), 2),)
    assert value.copies == ("a",)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a = b", ir.Assign((A,), B, 2)),
        ("a = b = c", ir.Assign((A, B), C, 2)),
        ("a += b", ir.Assign((A,), ir.Binary("+", A, B, 2), 2)),
        ("a <<= 1", ir.Assign((A,), ir.Binary("<<", A, ONE, 2), 2)),
        ("a++", ir.Assign((A,), ir.Binary("+", A, ONE, 2), 2)),
        ("--a", ir.Assign((A,), ir.Binary("-", A, ONE, 2), 2)),
        ("a.b[1] = c", ir.Assign((ir.Index(ir.Attr(A, "b"), ONE),), C, 2)),
        ("*a = b", ir.Assign((A,), B, 2)),
        ("delete a", ir.Delete((A,))),
        ("delete[] a", ir.Delete((A,))),
    ],
)
def test_expressions_that_are_statements(text, value):
    assert statement(f"{text};") == value


def test_what_an_expression_changes_stands_before_its_statement():
    add = ir.Assign((B,), ir.Binary("+", B, ONE, 2), 2)
    old = ir.Binary("-", B, ONE, 2)
    assert statements("a[b++] = c;") == (add, ir.Assign((ir.Index(A, old),), C, 2))
    assert statements("f(++b);") == (add, ir.Evaluate(ir.Call(ir.Name("f"), (B,), (), 2), 2))
    assert statements("f(a = b);") == (
        ir.Assign((A,), B, 2),
        ir.Evaluate(ir.Call(ir.Name("f"), (A,), (), 2), 2),
    )
    assert statements("a, b;") == (ir.Evaluate(A, 2), ir.Evaluate(B, 2))


def test_what_may_not_be_evaluated_is_not_put_before():
    assert expression("a && (b = c)") == ir.Logic("and", (A, ir.Opaque((B, C), "b = c")))


def test_a_chain_longer_than_the_bound_keeps_its_last_operands():
    found = expression("a" + " << f(b)" * 500)
    depth = 0
    while isinstance(found, ir.Binary):
        found, depth = found.left, depth + 1
    assert depth == 45
    assert isinstance(found, ir.Opaque)
    assert found.parts[-1] == ir.Call(ir.Name("f"), (B,), (), 2)
    assert len(found.parts) == 500 - 45 + 1


@pytest.mark.parametrize(
    ("written", "type"),
    [
        ("Foo<A>", ir.TypeRef("Foo", (ir.TypeRef("A"),))),
        ("n::Foo<A>", ir.TypeRef("n::Foo", (ir.TypeRef("A"),))),
        ("Foo<A<int>>", ir.TypeRef("Foo", (ir.TypeRef("A", (INT,)),))),
        ("Foo<A>, 3", ir.TypeRef("Foo", (ir.TypeRef("A"),))),
    ],
)
@pytest.mark.parametrize("outer", ["f", "n::f"])
def test_a_template_argument_is_a_type_wherever_the_call_stands(written, type, outer):
    """The grammar takes it for a function in the first argument of `n::f`."""
    (call,) = expression(f"{outer}(std::make_shared<{written}>(a))").args
    assert call.function.types[0] == type
