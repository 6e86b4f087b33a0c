"""Broken and hostile C++: nothing is raised, the rest of the file is read."""

import pickle

import pytest
from cpp_cases import unit
from hypothesis import given, settings
from hypothesis import strategies as st

from example_budget import examples
from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp import lower_cpp

GOOD = b"""#include "a.h"
#define NAME(x) "n" #x
namespace n { class A : public B<int> { A() : b_(1) { pub = nh.advertise<M>("t", 1); } int b_{2}; };
void A::f(const T& x) { for (auto& v : x) { switch (v) { case 1: g(v++); break; default: h(); } } }
} // n
#if defined(X)
#endif
"""


@given(st.binary(max_size=300))
@settings(max_examples=examples(200), deadline=None)
def test_bytes_never_raise(data):
    assert lower_cpp("f.cpp", data).language is ir.SourceLanguage.CPP


@given(st.integers(0, len(GOOD)), st.integers(0, 20), st.binary(max_size=8))
@settings(max_examples=examples(300), deadline=None)
def test_changed_source_never_raises(at, cut, put):
    found = lower_cpp("f.cpp", GOOD[:at] + put + GOOD[at + cut :])
    assert pickle.loads(pickle.dumps(found)) == found


@pytest.mark.parametrize(
    "text",
    [
        "void f() { x = " + "(" * 5000,
        "void f() {" + "if (a) {" * 5000 + "}" * 5000 + "}",
        "void f() {" + "if (a) {} else " * 5000 + ";}",
        "void f() { a" + "()" * 5000 + ";}",
        "A<" * 5000 + "B" + ">" * 5000 + " x;",
        "int x = " + "a::" * 5000 + "b;",
        "int " + "*" * 5000 + "x;",
        "namespace a {" * 5000,
        "#define F(x) x x\nint y = " + "F(" * 5000 + "1" + ")" * 5000 + ";",
        "FOO(\n" * 5000,
        "\n" * 100_000,
    ],
)
def test_depth_is_bounded(text):
    assert pickle.loads(pickle.dumps(lower_cpp("f.cpp", text.encode())))


def test_an_error_is_noted_and_the_rest_is_read():
    found = lower_cpp("f.cpp", b'void f() { a(); }\nint 3 = ;\nvoid g() { b("x"); }\n')
    assert [function.name for function in found.functions] == ["f", "g"]
    assert {problem.line for problem in found.problems} == {2}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_encodings(encoding):
    (one,) = lower_cpp("f.cpp", 'auto x = "\u00e9";\r\n'.encode(encoding)).body
    assert one.value == ir.Const("\u00e9")


def test_a_file_too_large_is_a_problem():
    found = lower_cpp("f.cpp", b" " * (4 * 2**20 + 1))
    assert [problem.why for problem in found.problems] == ["larger than 4 MiB; not read"]
    assert lower_cpp("f.cpp", b" " * (4 * 2**20)).problems == ()


def test_nuls_are_spaces():
    assert unit("int\0x;").body[0].name == "x"
