"""Namespaces, classes and functions of C++, lowered."""

import pytest
from cpp_cases import FOO, INT, A, unit

from rtron.sources.code import ir


def names(text):
    return [function.name for function in unit(text).functions]


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("void f() {}", "f"),
        ("namespace x { void ns::Foo::bar() {} }", "x::ns::Foo::bar"),
        ("namespace x { void x::Foo::bar() {} }", "x::Foo::bar"),
        ("namespace y { namespace x { void x::Foo::bar() {} } }", "y::x::Foo::bar"),
        ("namespace x { void x::Foo<a::b>::bar() {} }", "x::Foo::bar"),
        ("namespace Foo { Foo::Foo() {} }", "Foo::Foo::Foo"),
        ("namespace a { namespace { void f(); } }", "a::f"),
        ("namespace a::b { void f() {} }", "a::b::f"),
        ("template <class T> Foo<T>::Foo() {}", "Foo::Foo"),
        ("Foo::~Foo() {}", "Foo::~Foo"),
        ("class A { struct B { void f(); }; };", "A::B::f"),
        ("class API_EXPORT A { void f(); };", "A::f"),
        ('extern "C" { int f(); }', "f"),
        ("A& A::operator=(const A& a) { }", "A::operator="),
    ],
)
def test_names_are_qualified(text, name):
    assert names(text) == [name]


def test_a_class():
    text = (
        "template <class T> class A : public n::B<T>, private C {\n explicit A("
        "int x = 1) : n::B<T>(x), y_{2} {}\n virtual void f(T& a, const T& b) ="
        " 0;\n int y_ = 3;\n static Foo* z;\n};"
    )
    lowered = unit(text)
    (made,) = lowered.classes
    assert (made.name, made.template, made.line) == ("A", ("T",), 1)
    assert made.bases == (ir.TypeRef("n::B", (ir.TypeRef("T"),)), ir.TypeRef("C"))
    assert made.fields == (
        ir.Declare("y_", INT, ir.Const(3), line=4),
        ir.Declare("z", FOO, pointer=True, static=True, line=5),
    )
    constructor, method = lowered.functions
    assert constructor.params == (ir.Param("x", INT, ir.Const(1)),)
    assert [name for name, _ in constructor.initialisers] == ["n::B", "y_"]
    assert method.body is None
    assert [param.reference for param in method.params] == [True, False]


def test_aliases_usings_enums_and_exports():
    text = (
        "namespace n { typedef T<int> P; using Q = Foo; namespace m = a::b; usi"
        "ng namespace std; using x::y;\nenum E { A, B = 1 << 2, C }; PLUGINLIB_"
        "EXPORT_CLASS(Foo, b::Base)\n}\nPLUGINLIB_DECLARE_CLASS(pkg, N, n::Foo,"
        " nodelet::Nodelet)\nRCLCPP_COMPONENTS_REGISTER_NODE(n::R)\ntypedef str"
        "uct { int x; } S;"
    )
    lowered = unit(text)
    assert lowered.aliases == (
        ("n::P", ir.TypeRef("T", (INT,))),
        ("n::Q", FOO),
        ("n::m", ir.TypeRef("a::b")),
    )
    assert lowered.usings == ("std", "x::y")
    enums = dict(lowered.enums)
    assert [enums[f"n::{name}"] for name in ("A", "B", "C", "E::A", "E::B", "E::C")] == [
        0,
        4,
        5,
    ] * 2
    assert lowered.exports == (("n::Foo", "b::Base"), ("n::Foo", "nodelet::Nodelet"), ("n::R", ""))
    assert [made.name for made in lowered.classes] == ["S"]


def test_variables_of_namespaces_are_qualified():
    assert unit("namespace n { Foo x(1), y; int Foo::k = 3; extern int z; }").body == (
        ir.Declare("n::x", FOO, ir.New(FOO, (ir.Const(1),), 1), line=1),
        ir.Declare("n::y", FOO, line=1),
        ir.Declare("n::Foo::k", INT, ir.Const(3), line=1),
    )


def test_words_of_qt():
    text = (
        "class A : public QObject { Q_OBJECT\npublic slots:\n void f();\nsignal"
        "s:\n void g(int);\n};\nvoid h() { emit g(1); connect(a, SIGNAL(g(int))"
        "); }"
    )
    assert names(text) == ["A::f", "A::g", "h"]
    assert unit("auto x = a;").body == (ir.Declare("x", None, A, line=1),)
