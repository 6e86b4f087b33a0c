"""What would make an endpoint and is in no lowered expression becomes a problem, with its line."""

import pytest

from rtron.sources.code.frontends.cpp import lower_cpp
from rtron.sources.code.frontends.cpp.lowering import endpoint_macros, unexpanded_macros
from rtron.sources.code.frontends.cpp.macros import Macro


def lost(text):
    """Return the lines of the calls that are lost in a file."""
    unit = lower_cpp("f.cpp", text.encode(), {})
    return [each.line for each in unit.problems if "a call of" in each.why]


@pytest.mark.parametrize(
    "text",
    [
        "void f() {\n  asm volatile(nh.advertise<A>(a));\n}",
        "struct S {\n  int n : nh.subscribe(a, 1);\n};",
        'static_assert(true);\n[[deprecated(nh.advertise<A>("x", 1))]] int x;',
    ],
)
def test_a_call_in_what_nothing_lowers(text):
    assert lost(text) == [2]


@pytest.mark.parametrize(
    "text",
    [
        'void f() { nh.advertise<A<B>>("x", 1).publish(a); }',
        "void f() { this->template create_publisher<A>(a, 1); }",
        "void f() { rclcpp_action::create_client<A>(node, a); }",
        'void f() { ros::Subscriber s(nh.subscribe("x", 1, &C::cb)); }',
        "void f() { g([&] { nh.subscribe(a, 1); }); }",
        "ros::Publisher advertise(const std::string & name);\nvoid N::subscribe(int) {}",
        'void f() { log("call subscribe(x) or advertise<T>(y)"); } // nh.advertise(x)',
        "using P = decltype(nh.advertise<A>(a));\nint n = sizeof(nh.subscribe(a));",
        "struct S { ros::Publisher p = nh.advertise<A>(a, 1); S() : q(nh.advertise<A>(a, 1)) {} };",
        "void f() { (nh.advertise<A>(names, 1), ...); x = {.p = nh.advertise<A>(a, 1)}; }",
    ],
)
def test_what_is_lowered_or_never_evaluated_is_not_lost(text):
    assert lost(text) == []


def test_macros_that_hold_an_endpoint():
    macros = {
        "ADVERTISE": Macro("nh.advertise<A>(name, 1)", ("name",)),
        "TOPIC": Macro("nh.advertise<A>(name, 1)"),
        "LOG": Macro("print(subscribed)", ("x",)),
    }
    assert endpoint_macros(macros) == ("ADVERTISE",)
    assert unexpanded_macros("f();\n  ADVERTISE (x);\nT();") == (("ADVERTISE", 2),)


def test_a_switch_that_falls_through_too_far():
    cases = " ".join(f"case {n}: f{n}();" for n in range(70))
    unit = lower_cpp("f.cpp", f"void f() {{\n  switch (a) {{ {cases} }}\n}}".encode(), {})
    assert [(each.line, each.why) for each in unit.problems] == [
        (2, "falls through more cases than are read")
    ]


def left_out(text):
    """Return what is noted of a file that the preprocessor has left something of."""
    unit = lower_cpp("f.cpp", text.encode(), {"KNOWN": "1"})
    return [(problem.line, problem.why) for problem in unit.problems]


CALL = 'nh.advertise<M>("x", 1);'


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        (f"#ifdef WITH_ARM\nvoid f() {{\n{CALL} }}\n#endif\n", "WITH_ARM"),
        (f"#if WITH_ARM && KNOWN\nvoid f() {{\n{CALL} }}\n#endif\n", "WITH_ARM"),
        (f"#if defined(A) || defined(B)\nvoid f() {{\n{CALL} }}\n#else\nint x;\n#endif\n", "A, B"),
        (f"#ifdef WITH_ARM\n#ifdef KNOWN\n{CALL}\n#endif\n#endif\n", "WITH_ARM"),
    ],
)
def test_a_call_that_a_macro_leaves_out_is_noted(text, missing):
    why = f"a call of advertise is left out: {missing} is not defined"
    assert left_out(text) == [(3, why)]


@pytest.mark.parametrize(
    "text",
    [
        f"#if 0\nvoid f() {{ {CALL} }}\n#endif\n",
        f"#ifdef _WIN32\nvoid f() {{ {CALL} }}\n#endif\n",
        f"#ifndef KNOWN\nvoid f() {{ {CALL} }}\n#endif\n",
        f"#ifdef KNOWN\nvoid f() {{ {CALL} }}\n#endif\n",
        f"#ifdef ROS1\nvoid f() {{ {CALL} }}\n#else\nvoid f() {{ {CALL} }}\n#endif\n",
        "#ifdef WITH_ARM\nvoid f() { other(); }\n#endif\n",
        f"#ifdef WITH_ARM\n// {CALL}\n#endif\n",
    ],
)
def test_what_no_build_has_or_another_branch_does_is_not_noted(text):
    assert left_out(text) == []
