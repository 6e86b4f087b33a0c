"""Programs that do not end, nest without end or grow: bounded, noted, and the rest still found."""

import pytest
import ros2_runs
from ros1_runs import cpp, names, python

from cpu_time import work_units
from rtron.sources.code.interpreter.execution import abstract_machine
from rtron.sources.code.interpreter.execution.abstract_machine import (
    MAX_CALLBACKS_PER_FUNCTION,
    MAX_STEPS,
)

UNITS = 200
UNKNOWN = "rospy.Time.now() > 5"

MANY_ROUNDS = "for a in range(128):\n for b in range(32):\n  for c in range(8):\n   "
ENDLESS_PYTHON = {
    "loop": "while True:\n    pass\n",
    "string": "x = 'a'\nwhile True:\n    x += x\n",
    "list": "l = [1]\nwhile 1:\n    l = l + l\n",
    "list in place": "l = [1]\nfor i in range(100):\n    l += l\n",
    "extend": "l = [1]\nfor i in range(100):\n    l.extend(l)\n",
    "recursion": "def f(n):\n    return f(n + 1)\nf(0)\n",
    "mutual recursion": "def f():\n    g()\ndef g():\n    f()\nf()\n",
    "lambda": "f = lambda n: f(n)\nf(1)\n",
    "constructor": "class A:\n    def __init__(self):\n        self.a = A()\nA()\n",
    "property": "class A:\n    @property\n    def p(self):\n        return self.p\nA().p\n",
    "own base": "class A(A):\n    pass\nA()\n",
    "attribute of itself": "class A:\n    def __getattr__(self, n):\n"
    "        return getattr(self, n)\nA().x\n",
    "itself imported": "import n\nimport n as m\nn.m.m\n",
    "generator": "def g():\n    for x in g():\n        yield x\nfor x in g():\n    pass\n",
    "a list in itself": "l = []\nl.append(l)\nx = l == l\nx = l in l\nstr(l)\n"
    "for i in l:\n    pass\n",
    "large numbers": "x = 9 ** 9 ** 9 ** 9\ny = 1 << 10 ** 9\n",
    "large repeats": "x = [0] * 10 ** 9\ny = range(10 ** 12)\nz = 'a' * 10 ** 12\n",
    "large formats": "x = '%1000000000d' % 1\n"
    "y = '{:>1000000000}'.format(1)\nz = f'{1:>1000000000}'\n",
    "large methods": "x = 'a'.center(10 ** 10)\ny = 'a'.zfill(10 ** 10)\nz = 'a'.ljust(10 ** 10)\n",
    "large replacement": "x = 'a' * 4000\ny = x.replace('a', x)\n",
    "joined": "x = 'a' * 4000\nfor i in range(9):\n    x = x.join([x, x])\n",
    "comprehension": "x = [a for a in range(99) for b in range(99) for c in range(99)]\n",
    "callbacks": MANY_ROUNDS + "rospy.Subscriber('x', Bool, lambda m, x=[]: 1)\n",
    "partial callbacks": "import functools\ndef f(m, x):\n    pass\n"
    + MANY_ROUNDS
    + "rospy.Subscriber('x', Bool, functools.partial(f, []))\n",
    "loops": "".join("    " * i + f"for i{i} in range(99):\n" for i in range(9))
    + "    " * 9
    + "x = 1\n",
    "unknown loops": "".join(" " * i + f"while u{i}():\n" for i in range(18))
    + " " * 18
    + "x = 1\n",
    "unknown branches": "def f(n):\n" + f"    if {UNKNOWN}: f(n)\n" * 20 + "f(1)\n",
    "options": "x = ''\n" + f"x += 'a' if {UNKNOWN} else 'b'\n" * 60,
    "decorator": "def d(f):\n    return d(d)\n@d\ndef x():\n    pass\nx()\n",
}


def in_time(run, *args, part=1):
    """Return what a run gives, which may take some seconds, or a part of them."""
    interface, units = work_units(run, *args)
    assert units < UNITS / part
    return interface


@pytest.fixture
def a_tenth_of_the_steps(monkeypatch):
    monkeypatch.setattr(abstract_machine, "MAX_STEPS", MAX_STEPS // 10)


@pytest.mark.parametrize("text", ENDLESS_PYTHON.values(), ids=ENDLESS_PYTHON.keys())
@pytest.mark.usefixtures("a_tenth_of_the_steps")
def test_python_that_does_not_end_is_bounded(text):
    assert "before" in names(in_time(python, "P('before')\n" + text, part=4))


@pytest.mark.long
def test_all_the_steps_that_a_program_may_take_end_in_time():
    assert "before" in names(in_time(python, "P('before')\n" + ENDLESS_PYTHON["loops"]))


STOPS = {"loops", "comprehension", "unknown branches", "loop", "string", "list"}
"""What may use up the steps, or never ends: what stands behind it is not run, or not certain."""


@pytest.mark.parametrize("name", sorted(ENDLESS_PYTHON.keys() - STOPS))
def test_what_stands_behind_is_still_found(name):
    assert "after" in names(python(ENDLESS_PYTHON[name] + "P('after')\n"))


ENDLESS_CPP = {
    "loop": ("for (;;);", ""),
    "string": ('std::string s = "a"; while (true) { s += s; }', ""),
    "vector": ("std::vector<int> v(1000000000); v.resize(2000000000); for (auto x : v) {}", ""),
    "filled": ("std::string s(1000000000, 'a');", ""),
    "template": ("A<3> a;", "template <int N> struct A { A<N - 1> a; };"),
    "constructor": ("A a;", "struct A { A* a; A() { a = new A(); } };"),
    "member of itself": ("A a;", "struct A { A a; };"),
    "base of itself": ("A a; a.foo();", "struct B; struct A : B {}; struct B : A {};"),
    "alias of itself": ("A a; B b;", "typedef A B; typedef B A;"),
    "global of itself": (
        "std::string s = a;",
        "extern std::string b; std::string a = b; std::string b = a;",
    ),
    "reference to itself": ("std::string& r = r; int& a = b; int& b = a;", ""),
    "reference to reference": (
        "std::string s; f(s);",
        "void f(std::string& s) { std::string& t = s; f(t); }",
    ),
    "operators": (
        "A a; a + a; a[0];",
        "struct A { A operator+(A a) { return a + a; } A operator[](int i) { return *this[i]; } };",
    ),
    "lambda": (
        "std::function<void()> f = [&] { f(); }; f(); auto g = [](auto h) { h(h); }; g(g);",
        "",
    ),
    "virtual": ("A a; a.f();", "struct A { virtual void f() { g(); } virtual void g() { f(); } };"),
    "includes": ("", '#include "n.cpp"'),
    "macros": ("A; F(F(1));", "#define A B\n#define B A\n#define F(x) F(F(x)) F(x)"),
    "iterator": ("std::vector<int> v; for (auto it = v.begin();; ++it) {}", ""),
    "a map in itself": (
        'std::map<std::string, int> m; m["a"] = m; m[m] = 1; for (auto& x : m) m["z"] = x;',
        "",
    ),
    "goto": ("again: goto again;", ""),
}


@pytest.mark.parametrize("case", ENDLESS_CPP.values(), ids=ENDLESS_CPP.keys())
def test_cpp_that_does_not_end_is_bounded(case):
    body, top = case
    before = 'nh.advertise<std_msgs::Bool>("before", 1);'
    assert "before" in names(in_time(cpp, before + body, top))


@pytest.mark.parametrize(
    "name", sorted(ENDLESS_CPP.keys() - {"loop", "string", "goto", "iterator"})
)
def test_what_stands_behind_in_cpp_is_still_found(name):
    body, top = ENDLESS_CPP[name]
    assert "after" in names(cpp(body + 'nh.advertise<std_msgs::Bool>("after", 1);', top))


NESTED = {
    "parentheses": lambda n: "x = " + "(" * n + "1" + ")" * n,
    "sum": lambda n: "x = " + "+".join(["a"] * n),
    "attributes": lambda n: "x = a" + ".b" * n,
    "calls": lambda n: "x = a" + "()" * n,
    "items": lambda n: "x = a" + "[0]" * n,
    "lists": lambda n: "x = " + "[" * n + "]" * n,
    "not": lambda n: "x = " + "not " * n + "1",
    "minus": lambda n: "x = " + "-" * n + "1",
    "lambdas": lambda n: "x = " + "lambda: " * n + "1",
    "ternaries": lambda n: "x = " + "1 if a else " * n + "1",
    "elif": lambda n: "if a: pass\n" + "elif a: pass\n" * n,
}


@pytest.mark.parametrize("depth", [60, 500, 5000])
@pytest.mark.parametrize("make", NESTED.values(), ids=NESTED.keys())
def test_deep_nesting_never_escapes(make, depth):
    interface = in_time(python, "P('before')\n" + make(depth) + "\nP('after')\n")
    assert names(interface) == ["before", "after"] or interface.unresolved


@pytest.mark.parametrize("depth", [60, 500, 5000])
@pytest.mark.parametrize(
    ("left", "middle", "right"),
    [("{", ";", "}"), ("x = (", "1", ");"), ("if (x) ", ";", ""), ("-", "1", ";")],
)
def test_deep_nesting_of_cpp_never_escapes(left, middle, right, depth):
    right = right * depth if right != ");" else ")" * depth + ";"
    left = "x = " + "(" * depth if left == "x = (" else left * depth
    body = f'nh.advertise<std_msgs::Bool>("before", 1); {left}{middle}{right} '
    interface = in_time(cpp, body)
    assert "before" in names(interface) or interface.unresolved


def test_known_loops_run_as_often_as_they_do():
    assert names(python("for i in range(100):\n    P('n%d' % i)\n")) == [
        f"n{i}" for i in range(100)
    ]


def test_a_longer_loop_is_not_cut_in_silence():
    interface = python("for i in range(5000):\n    P('n%d' % i)\n")
    assert interface.unresolved or any("{" in name for name in names(interface))


def test_a_recursion_that_ends_is_run_to_its_end():
    text = "def f(n):\n    if n == 0:\n        P('bottom')\n    else:\n        f(n - 1)\nf({})\n"
    assert names(python(text.format(2))) == ["bottom"]
    deep = python(text.format(6))
    assert names(deep) == ["bottom"] or deep.unresolved


def test_calls_too_deep_are_noted():
    chain = "".join(f"def f{i}():\n    f{i + 1}()\n" for i in range(400))
    interface = python(chain + "def f400():\n    P('bottom')\nf0()\n")
    assert names(interface) == ["bottom"] or interface.unresolved


@pytest.mark.usefixtures("a_tenth_of_the_steps")
def test_a_program_too_large_is_noted():
    loops = "".join("    " * i + f"for i{i} in range(99):\n" for i in range(6))
    interface = python("P('before')\n" + loops + "    " * 6 + "x = 1\nP('after')\n")
    assert names(interface)[0] == "before"
    assert names(interface) == ["before", "after"] or interface.unresolved


BAD_CALLS = """
Publisher Subscriber Service ServiceProxy get_param has_param set_param search_param
resolve_name Timer wait_for_message wait_for_service on_shutdown names.ns_join
"""


@pytest.mark.parametrize("called", BAD_CALLS.split())
@pytest.mark.parametrize(
    "given", ["", "None", "5, 5, 5", "[], {}", "*x, **y", "name=3", "lambda: 1", "b'x', 'y'"]
)
def test_calls_with_wrong_arguments_do_not_fail(called, given):
    interface = python(f"rospy.{called}({given})\nP('after')\n")
    assert names(interface)[-1:] == ["after"]


CPP_CALLS = """
nh.advertise<S>({0})
nh.subscribe({0})
nh.param({0})
nh.getParam({0})
nh.searchParam({0})
nh.advertiseService({0})
nh.serviceClient<S>({0})
ros::NodeHandle({0})
ros::param::get({0})
ros::topic::waitForMessage<S>({0})
std::to_string({0})
boost::bind({0})
sprintf({0})
s.substr({0})
s.find({0})
s.erase({0})
s.insert({0})
s.replace({0})
s.at({0})
v.at({0})
v.resize({0})
v.insert({0})
v.erase({0})
m.at({0})
m.insert({0})
std::get<9>({0})
std::vector<int> w({0})
std::string t({0})
actionlib::SimpleActionClient<S> a({0})
message_filters::Subscriber<S> f({0})
bond::Bond b({0})
image_transport::ImageTransport it({0}); it.advertise({0}); it.subscribeCamera({0})
pluginlib::ClassLoader<S> c({0}); c.createInstance({0})
ros::names::append({0})
std::make_shared<S>({0})
"""


@pytest.mark.parametrize("called", CPP_CALLS.split("\n")[1:-1])
@pytest.mark.parametrize(
    "given",
    [
        "",
        '"x"',
        "-9",
        "other, other",
        "5, 5, 5, 5",
        "&other, NULL",
        '"x", "y", "z"',
        "v, m",
        "2.5, true",
    ],
)
def test_cpp_calls_with_wrong_arguments_do_not_fail(called, given):
    body = 'std::string s = "abc"; std::vector<std::string> v; std::map<std::string, int> m; '
    body += "ros::NodeHandle other; "
    after = '; nh.advertise<std_msgs::Bool>("after", 1);'
    interface = cpp(body + called.format(given) + after, "typedef std_msgs::Bool S;")
    assert names(interface)[-1:] == ["after"]


@pytest.mark.parametrize(
    ("more", "skipped_entries"), [(0, []), (1, ["more callbacks than are run"])]
)
def test_so_many_callbacks_of_one_function_are_run(more, skipped_entries):
    define = "def f(n):\n    rospy.Timer(1, lambda event, n=n: P('t' + str(n)))\n"
    interface = python(
        f"{define}for i in range({MAX_CALLBACKS_PER_FUNCTION}):\n    f(i)\n" + "f('more')\n" * more
    )
    assert names(interface) == [f"t{n}" for n in range(MAX_CALLBACKS_PER_FUNCTION)]
    assert [one.why for one in interface.unresolved] == skipped_entries


def test_too_many_callbacks_that_join_nothing_are_not_noted():
    interface = python(f"{MANY_ROUNDS}rospy.Timer(1, lambda event, n=(a, b, c): n)\nP('last')\n")
    assert names(interface) == ["last"]
    assert interface.unresolved == ()


WAITS = """
struct Driver {
  void wait() { while (!found_) { %s } }
  void start() { ros::NodeHandle nh; pub_ = nh.advertise<std_msgs::Bool>("out", 1); }
  void init() { wait(); thread_ = boost::thread(boost::bind(&Driver::start, this)); }
  bool found_ = false;
  boost::thread thread_;
  ros::Publisher pub_;
};
"""


def test_who_hands_on_what_joins_nodes_is_run_behind_a_wait_that_takes_all_its_steps():
    top = WAITS % ("int a = 1 + 2 + 3;" * 40)
    assert names(cpp("Driver driver; driver.init(); ros::spin();", top)) == ["out"]


COMPUTING = """double half(double x) { double a = x; double b = a; return b / 2; }
  std::string with(std::string name) { std::string a = name; std::string b = a; return b; }
  void tick() { for (int i = 0; i < 100; i++) { for (int j = 0; j < 30; j++) { half(3); with("n"); }
    } create_publisher<std_msgs::msg::Bool>("h" + std::to_string(half(4.0)), 1);
    create_publisher<std_msgs::msg::Bool>(with("own"), 1); }"""


def test_what_computes_and_handles_no_text_is_run_for_so_many_steps_by_callbacks():
    timer = "create_wall_timer(1s, std::bind(&N::tick, this));"
    found = ros2_runs.cpp(timer, members=COMPUTING)
    assert ros2_runs.names(found) == ["/ns/h{N::half()}", "/ns/own"]
    once = ros2_runs.cpp("tick();", members=COMPUTING)
    assert ros2_runs.names(once) == ["/ns/h2.000000", "/ns/own"]


NAMESAKE = """void start() { create_publisher<std_msgs::msg::Bool>("out", 1); }
  double sum(double start) { double at = start;
    for (int i = 0; i < 100; i++) { for (int j = 0; j < 30; j++) { at = at + 1; } }
    return at; }"""


def test_a_variable_is_not_the_function_of_its_name_that_joins_nodes():
    made = 'start(); create_publisher<std_msgs::msg::Bool>("h" + std::to_string(sum(1.0)), 1);'
    found = ros2_runs.cpp(made, members=NAMESAKE)
    assert ros2_runs.names(found) == ["/ns/out", "/ns/h{N::sum()}"]


HELD_PLUGIN = """
struct Plugin {
  ros::NodeHandle nh;
  ros::Publisher pub;
  double limit;
  void start() {
    for (int i = 0; i < 100; i++)
      for (int k = 0; k < 20; k++) limit = limit + i * k;
    pub = nh.advertise<std_msgs::Bool>("far", 1);
  }
};
struct Manager {
  boost::function<void()> held;
  void load() { held(); }
};
"""


def test_what_a_held_function_makes_is_found_however_much_it_computes_before():
    body = "Plugin p; Manager m; m.held = boost::bind(&Plugin::start, &p); m.load();"
    assert names(cpp(body, HELD_PLUGIN)) == ["far"]
