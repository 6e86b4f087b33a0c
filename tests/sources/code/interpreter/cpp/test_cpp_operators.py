"""Operators that classes have, packs, jumps out of a switch, static variables, specialisations."""

import pytest
from ros1_runs import cpp, names

HANDLE = "ros::NodeHandle & nh"
ADVERTISE = "nh.advertise<std_msgs::Bool>({}, 1);"
TOPICS = """
struct Topics {
  ros::NodeHandle nh; ros::Publisher last;
  void make(std::string name) { last = nh.advertise<std_msgs::Bool>(name, 1); }
  ros::Publisher & operator[](std::string name) { make(name); return last; }
  Topics & operator+=(std::string name) { make(name); return *this; }
  Topics & operator<<(std::string name) { make(name); return *this; }
  Topics * operator->() { make("arrow"); return this; }
  bool operator!() { make("not"); return false; }
  void operator()(std::string name) { make(name); }
};
"""


@pytest.mark.parametrize(
    ("use", "expected"),
    [
        ('t["x"];', ["x"]),
        ('t["x"] = ros::Publisher();', ["x"]),
        ('t += "x"; t += "y";', ["x", "y"]),
        ('t << "x" << "y";', ["x", "y"]),
        ('t("x");', ["x"]),
        ("if (!t) { }", ["not"]),
    ],
)
def test_an_operator_of_a_class_is_called(use, expected):
    found = cpp("Topics t; " + use, TOPICS)
    assert names(found) == expected


def test_a_member_behind_an_arrow_of_a_class():
    top = "struct Inner { ros::NodeHandle nh; void go() { " + ADVERTISE.format('"x"') + " } };"
    top += "struct Outer { Inner inner; Inner * operator->() { return &inner; } };"
    assert names(cpp("Outer o; o->go();", top)) == ["x"]


@pytest.mark.parametrize("call", ["(c.*go)", "(p->*go)"])
def test_a_method_by_pointer(call):
    top = (
        "struct C { ros::NodeHandle nh; void go(std::string n) { " + ADVERTISE.format("n") + " } };"
    )
    assert names(cpp(f'C c; C * p = &c; auto go = &C::go; {call}("x");', top)) == ["x"]


@pytest.mark.parametrize(
    "body",
    [
        f"({ADVERTISE.format('names')[:-1]}, ...);",
        f"int all[] = {{({ADVERTISE.format('names')[:-1]}, 0)...}};",
        f"for (auto n : {{std::string(names)...}}) {{ {ADVERTISE.format('n')} }}",
    ],
)
def test_each_item_of_a_pack(body):
    for kind in ("T", "const T &", "T &&"):
        top = f"template <class... T> void f({HANDLE}, {kind}... names) {{ {body} }}"
        assert names(cpp('std::string a = "a"; f(nh, a, "b");', top)) == ["a", "b"], kind


def test_a_continue_in_a_switch_is_the_loops():
    body = """for (int i = 0; i < 3; i++) {
      switch (i) { case 0: break; case 1: continue; default: if (i == 2) { break; } }
      nh.advertise<std_msgs::Bool>("n" + std::to_string(i), 1);
    }"""
    assert names(cpp(body)) == ["n0", "n2"]


def test_what_a_switch_decides_on_is_run_without_any_case():
    top = f"int f({HANDLE}) {{ {ADVERTISE.format(chr(34) + 'x' + chr(34))} return 1; }}"
    assert names(cpp("switch (f(nh)) { default: break; }", top)) == ["x"]


def test_a_static_variable_keeps_its_value():
    top = f"void f({HANDLE}) {{ static int n = 0; n++; "
    top += ADVERTISE.format('"n" + std::to_string(n)') + " }"
    assert names(cpp("f(nh); f(nh);", top)) == ["n1", "n2"]


def test_an_object_before_main_may_have_no_written_type():
    top = "int made(std::string n) { ros::NodeHandle nh; " + ADVERTISE.format("n") + " return 1; }"
    top += 'static auto a = made("a"); const auto b = made("b");'
    top += 'struct S { inline static auto c = made("c"); };'
    assert sorted(names(cpp("", top))) == ["a", "b", "c"]


def test_a_friend_that_a_class_defines():
    make = ADVERTISE.format('"x"')
    top = f"class A {{ friend void f(A & a, {HANDLE}) {{ {make} }} }};"
    assert names(cpp("A a; f(a, nh);", top)) == ["x"]


def test_what_a_template_is_specialised_as():
    top = """
    template <class T> struct Topic { static std::string name() { return "any"; } };
    template <> struct Topic<std_msgs::Bool> { static std::string name() { return "bool"; } };
    template <class T> std::string text();
    template <> std::string text<int>() { return "int"; }
    template <> std::string text<double>() { return "double"; }
    """
    calls = ("Topic<int>::name()", "Topic<std_msgs::Bool>::name()", "text<int>()", "text<double>()")
    body = " ".join(ADVERTISE.format(call) for call in calls)
    assert names(cpp(body, top)) == ["any", "bool", "int", "double"]


def test_which_of_two_types_decides():
    top = """template <class T> std::string text() {
      if constexpr (std::is_same_v<T, int>) { return "int"; } else { return "other"; } }"""
    body = ADVERTISE.format("text<int>()") + ADVERTISE.format("text<bool>()")
    assert names(cpp(body, top)) == ["int", "other"]


def test_the_distance_of_letters_is_a_number():
    body = """std::string name = "can12"; int last = name.back() - '0';
    nh.advertise<std_msgs::Bool>("bus" + std::to_string(last), 1);
    if (last != 2) { nh.advertise<std_msgs::Bool>("no", 1); }"""
    assert names(cpp(body)) == ["bus2"]
