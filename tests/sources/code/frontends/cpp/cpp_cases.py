"""C++ lowered for the tests: a unit, a function's statements, one expression."""

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp import lower_cpp

A, B, C = ir.Name("a"), ir.Name("b"), ir.Name("c")
INT, FOO = ir.TypeRef("int"), ir.TypeRef("Foo")


def unit(text, defined=None):
    lowered = lower_cpp("f.cpp", text.encode(), defined or {})
    assert lowered.problems == ()
    return lowered


def statements(text):
    """The statements of a function; its text begins on line 2."""
    (function,) = unit(f"void f() {{\n{text}\n}}").functions
    return function.body


def statement(text):
    (one,) = statements(text)
    return one


def expression(text):
    one = statement(f"{text};")
    assert isinstance(one, ir.Evaluate)
    return one.value
