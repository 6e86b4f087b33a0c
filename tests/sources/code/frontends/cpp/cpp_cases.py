"""C++ lowered for the tests: a unit, a function's statements, one expression."""

from rtron.sources.code.frontends.cpp import lower_cpp
from rtron.sources.code.ir import Evaluate, Name, TypeRef

A, B, C, D = Name("a"), Name("b"), Name("c"), Name("d")
INT, FOO = TypeRef("int"), TypeRef("Foo")


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
    assert isinstance(one, Evaluate)
    return one.value


def initial(text):
    """The value a variable begins with."""
    return statement(text).value
