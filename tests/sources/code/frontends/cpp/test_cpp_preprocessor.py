"""The preprocessor: branches, macros, lines."""

import pytest
from cpp_cases import unit

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.preprocessor import preprocess


def code(text, defined=None):
    read = preprocess(text, defined or {})
    assert read.code.count("\n") == text.count("\n")
    return read.code.split()


@pytest.mark.parametrize(
    ("condition", "holds"),
    [
        ("1", True),
        ("0", False),
        ("UNKNOWN", False),
        ("!UNKNOWN", True),
        ("defined(KNOWN)", True),
        ("defined KNOWN && !defined(UNKNOWN)", True),
        ("defined(UNKNOWN) || KNOWN > 2", True),
        ("KNOWN == 3", True),
        ("KNOWN - 1 - 1 == 1", True),
        ("2 + 2 * 2 == 6", True),
        ("(2 + 2) * 2 == 8", True),
        ("1 ? 0 : 1", False),
        ("0x10 == 16 && 010 == 8 && 1000L == 1'000", True),
        ("TWICE(KNOWN) == 6", True),
        ("__cplusplus >= 201103L", True),
        ("__cplusplus > 201402L", False),
        ("ROS_VERSION_MINIMUM(1, 8, 0)", True),
        ("CV_MAJOR_VERSION >= 3", True),
        ("ROS_VERSION_MINOR < 10", False),
        ("OTHER_VERSION_MAJOR > 3 && OTHER_VERSION_MAJOR <= 4", False),
        ("OTHER_VERSION == 2", False),
        ("OTHER_VERSION", False),
        ("defined(__linux__) && defined(__GNUC__)", True),
        ("defined(_WIN32) || defined(_MSC_VER)", False),
        ("UNKNOWN(1, 2)", False),
        ("__has_include(<x.h>)", False),
        ("true and not false", True),
        ("'a' == 97", True),
    ],
)
def test_conditions(condition, holds):
    text = "#define KNOWN 3\n#define TWICE(x) ((x) * 2)\n"
    assert code(f"{text}#if {condition}\nyes\n#else\nno\n#endif\n") == ["yes" if holds else "no"]


@pytest.mark.parametrize(
    "condition", ["", "1 +", "(1", "1 / 0", "1 % 0", "@", "'", "1 ? 2", "(" * 999]
)
def test_a_condition_that_cannot_be_read_is_false_and_a_problem(condition):
    read = preprocess(f"a\n#if {condition}\nyes\n#else\nno\n#endif\n", {})
    assert read.code.split() == ["a", "no"]
    assert [problem.line for problem in read.problems] == [2]


def test_branches():
    text = "#if 0\na\n#elif 1\nb\n#elif 1\nc\n#else\nd\n#endif\ne"
    assert code(text) == ["b", "e"]


def test_branches_within_dead_branches_are_dead():
    text = (
        "#if 0\n#if 1\na\n#else\nb\n#endif\n#define X\n#else\n#ifdef X\nc\n#else\nd\n#endif\n#endif"
    )
    assert code(text) == ["d"]


def test_guards_and_given_definitions():
    assert code("#ifndef F_H\n#define F_H\na\n#endif\n") == ["a"]
    assert code("#ifdef GPU\na\n#endif\nGPU\n", {"GPU": "1"}) == ["a", "1"]
    assert code("#define X 1\n#undef X\n#ifdef X\na\n#endif\nX") == ["X"]


@pytest.mark.parametrize("text", ["#if 1\na", "a\n#endif", "a\n#else"])
def test_unbalanced_branches_are_problems(text):
    read = preprocess(text, {})
    assert read.code.split() == ["a"]
    assert [problem.line for problem in read.problems] == [1 if "#if" in text else 2]


@pytest.mark.parametrize(
    ("macro", "use", "becomes"),
    [
        ("X 1", "X XX _X x.X", "1 XX _X x.1"),
        ("X", "a X b", "a b"),
        ('X "X"', 'X "X" R"(X)"', '"X" "X" R"(X)"'),
        ("X 1 \\\n + 2 // c", "X", "1 + 2"),
        ("X /* c */ 1", "X", "1"),
        ("F(x) g(x, x)", "F(a) F (b) F", "g(a, a) g(b, b) F"),
        ("F(x, y) y x", 'F(g(1, 2), ")")', '")" g(1, 2)'),
        ("F() 1", "F()", "1"),
        ("F(x) #x", 'F(a "b")', r'"a \"b\""'),
        ("F(x) n_##x", "F(a)", "n_a"),
        ("F(x, ...) g(x, __VA_ARGS__)", "F(1, 2, 3)", "g(1, 2, 3)"),
        ("F(x) F(x)", "F(F(1))", "F(F(1))"),
        ("X X + Y\n#define Y X", "X", "X + X"),
        ("F(x) G(x)\n#define G(x) <x>", "F(F(1))", "<<1>>"),
        ("X F\n#define F(x) <x>", "X(1)", "<1>"),
        ("X 1", "F(\nX\n)", "F( 1 )"),
        ("F(x) x", "F(\n1\n) 2", "1 2"),
    ],
)
def test_macros(macro, use, becomes):
    assert " ".join(code(f"#define {macro}\n{use}\n")) == becomes


def test_comments_go_and_strings_stay():
    assert code("a /* b\n#define a c\n*/ a // d \\\n e\n\"//\" '\"' /**/ f") == [
        "a", "a", '"//"', "'\"'", "f",
    ]  # fmt: skip


def test_includes_are_kept_as_written_where_they_live():
    text = '#include <a.h> // x\n#include "b/c.h"\n#if 0\n#include <no.h>\n#endif\n'
    assert unit(text).includes == ("<a.h>", '"b/c.h"')


def test_macros_that_are_expressions_are_declared_for_other_files():
    text = '#define TOPIC "/a" "b"\n#define N 3\n#define T n::f\n'
    text += "#define F(x) x\n#define G\n#define S if (\n"
    assert unit(text).body == (
        ir.Declare("TOPIC", None, ir.Const("/ab"), static=True, line=1),
        ir.Declare("N", None, ir.Const(3), static=True, line=2),
        ir.Declare("T", None, ir.Name("n::f"), static=True, line=3),
    )


def test_expansion_is_bounded():
    text = "#define A0 x\n" + "".join(f"#define A{n + 1} A{n} A{n}\n" for n in range(60))
    read = preprocess(f"{text}A60\nA2\n", {})
    assert read.code.split() == ["A60", "x", "x", "x", "x"]
    assert read.problems == (ir.SourceProblem(62, "A60 expands to too much text; not expanded"),)
    read = preprocess(text + "A60\n" * 20, {})
    assert read.code.split() == ["A60"] * 20
    assert read.problems == (
        *(ir.SourceProblem(62 + n, "A60 expands to too much text; not expanded") for n in range(4)),
        ir.SourceProblem(82, "macros expand to too much text; the rest is not expanded"),
    )


@pytest.mark.parametrize("depth", [20, 30, 250])
def test_nested_uses_are_bounded(depth):
    use = "F(" * depth + "\n1" + ")" * depth
    read = preprocess(f"#define F(x) x x\n\na {use}; F(b)\n", {})
    assert read.code == f"\n\na {use}; b b\n"
    assert read.problems == (ir.SourceProblem(3, "F expands to too much text; not expanded"),)


def test_a_long_condition_is_noted_where_it_stands():
    read = preprocess("#define F(x) x x\n#if " + "F(" * 30 + "0" + ")" * 30 + "\na\n#endif\n", {})
    assert ir.SourceProblem(2, "F expands to too much text; not expanded") in read.problems


def test_nested_uses_are_expanded_within_the_bound():
    read = preprocess("#define F(x) x x\n" + "F(" * 12 + "1" + ")" * 12 + "\n", {})
    assert read.code.split() == ["1"] * 2**12
    assert read.problems == ()


@pytest.mark.parametrize("body", ["x " * 300_000, "x #x " * 100_000])
def test_a_long_body_is_bounded(body):
    read = preprocess(f"#define F(x) {body}\nF(123)\nF(1234567890)\n", {})
    assert read.code.split() == ["F(123)", "F(1234567890)"]
    assert [problem.line for problem in read.problems] == [2, 3]


def test_a_long_body_is_read_once():
    body = "x##y " + " " * 200_000 + "+ y" + " x" * 50_000
    (code,) = preprocess(f"#define F(x, y) {body}\nF(a, b)\n", {}).code.strip().split("\n")
    assert code.split() == ["ab", "+", "b", *["a"] * 50_000]
