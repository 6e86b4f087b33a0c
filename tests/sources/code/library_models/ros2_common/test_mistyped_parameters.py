"""Parameters that a launch gives in another type than a node of ROS 2 declares."""

import pytest
from ros2_runs import cpp, names, python, run_text, settings

TRY = 'try {{ declare_parameter("p", 1.0); }} catch (const {}& error) {{}}'
MADE = "n = rclpy.create_node('o', automatically_declare_parameters_from_overrides=True)"


def types(interface):
    """Return what the node declares `p` as, and what it is given."""
    return [(each.declared_type, each.given_type) for each in interface.mistyped]


@pytest.mark.parametrize(
    ("declared", "type"),
    [
        ('"p", 1.0', "double"),
        ('"p", rclcpp::ParameterValue(1.0)', "double"),
        ('"p", rclcpp::PARAMETER_DOUBLE', "double"),
        ('"p", true', "bool"),
        ('"p", "text"', "string"),
        ('"p", std::string("text")', "string"),
    ],
)
def test_a_default_of_cpp_says_the_type(declared, type):
    found = cpp(f"declare_parameter({declared});", settings=settings(p=1))
    assert types(found) == [(type, "integer")]


@pytest.mark.parametrize(
    ("template", "type"),
    [
        ("double", "double"),
        ("float", "double"),
        ("std::string", "string"),
        ("bool", "bool"),
        ("std::vector<double>", "double_array"),
    ],
)
@pytest.mark.parametrize("default", ["", ", value"])
def test_a_template_argument_says_the_type(template, type, default):
    body = f'declare_parameter<{template}>("p"{default});'
    assert types(cpp(body, settings=settings(p=1))) == [(type, "integer")]


@pytest.mark.parametrize(
    ("declared", "given", "expected"),
    [
        ("1.0", 1, ("double", "integer")),
        ("1", 1.0, ("integer", "double")),
        ("True", 1, ("bool", "integer")),
        ("1", False, ("integer", "bool")),
        ("'text'", 1.5, ("string", "double")),
        ("1.0", "fast", ("double", "string")),
        ("[1.0]", [0, 0], ("double_array", "integer_array")),
        ("Parameter.Type.DOUBLE", 1, ("double", "integer")),
    ],
)
def test_a_default_of_python_says_the_type(declared, given, expected):
    top = "from rclpy.parameter import Parameter"
    found = python(f"self.declare_parameter('p', {declared})", top, settings=settings(p=given))
    assert types(found) == [expected]


@pytest.mark.parametrize(
    ("declared", "given"),
    [
        ("1.0", 2.0),
        ("1.0", None),
        ("None", 1),
        ("unknown()", 1),
        ("[]", [1]),
        ("[1.0, 2.0]", [1, 2.0]),
        *(("1.0", text) for text in ("", "1e3", "-.5", "~")),
        *(("True", text) for text in ("y", "No", "on")),
    ],
)
def test_a_type_that_fits_or_is_not_certain_says_nothing(declared, given):
    set_by_launch = settings(p=given) if given is not None else ()
    body = f"self.declare_parameter('p', {declared})"
    assert not types(python(body, settings=set_by_launch))


@pytest.mark.parametrize("value", ["whole", "5", "static_cast<double>(5)"])
def test_an_int_of_cpp_may_be_a_double(value):
    body = f'double whole = 5; declare_parameter("p", {value});'
    assert not types(cpp(body, settings=settings(p=1.5)))


def test_a_type_that_a_template_gets_is_not_known():
    top = 'template <class T> void say(rclcpp::Node* n, T d) { n->declare_parameter<T>("p", d); }'
    assert not types(cpp("say<double>(this, 5);", top, settings=settings(p=1.5)))


def test_one_of_several_declared_at_once():
    body = "self.declare_parameters('a', [('p', 1.0), ('q', 1)])"
    given = settings(a__p=1, a__q=1, p=True)
    assert [each.name for each in python(body, settings=given).mistyped] == ["a.p"]


@pytest.mark.parametrize(
    "body",
    [
        "self.declare_parameters('', [('p', 1.0, descriptor)])",
        "self.declare_parameters('', [('p', 1.0)], True)",
        "self.declare_parameter('p', 1.0, descriptor)",
        "self.declare_parameter('p', 1.0, ignore_override=True)",
        "if unknown():\n    self.declare_parameter('p', 1.0)",
        "try:\n    self.declare_parameter('p', 1.0)\nexcept Exception:\n    pass",
        f"{MADE}\nn.declare_parameter('p', 1.0)",
    ],
)
def test_what_may_not_throw_says_nothing(body):
    assert not types(python(body, settings=settings(p=1)))


@pytest.mark.parametrize(("caught", "found"), [("std::exception", []), ("std::bad_alloc", ["p"])])
def test_an_exception_that_is_caught_says_nothing(caught, found):
    interface = cpp(TRY.format(caught), settings=settings(p=1))
    assert [each.name for each in interface.mistyped] == found


def test_a_file_that_is_not_known_may_give_another_value():
    body = "self.declare_parameter('p', 1.0)"
    assert not types(python(body, settings=settings(p=1), parameters_complete=False))


def test_what_is_declared_already_keeps_its_type():
    body = "self.declare_parameter('p', 1)\nself.declare_parameter('p', 1.0)"
    assert not types(python(body, settings=settings(p=1)))


def test_the_node_and_the_place_are_known():
    (found,) = run_text(
        "import rclpy\ndef main():\n    rclpy.create_node('n').declare_parameter('p', 1.0)\n",
        "py",
        settings=settings(p=1),
    ).mistyped
    assert (found.node, found.name, found.evidence.line) == ("/ns/n", "p", 3)


DECLARED = 'declare_parameter("topic", rclcpp::PARAMETER_STRING);'
READS = {
    "a variable": """std::string topic = "default";
        if (get_parameter("topic", topic)) { create_publisher<std_msgs::msg::Bool>("told", 1); }
        create_publisher<std_msgs::msg::Bool>(topic, 1);""",
    "an alternative": """std::string topic;
        get_parameter_or("topic", topic, std::string("default"));
        create_publisher<std_msgs::msg::Bool>(topic, 1);""",
    "a handler": """std::string topic;
        try { topic = get_parameter("topic").as_string(); }
        catch (const rclcpp::exceptions::ParameterUninitializedException &) { topic = "default"; }
        create_publisher<std_msgs::msg::Bool>(topic, 1);""",
    "its kind": """std::string topic = "default";
        auto held = declare_parameter("topic", rclcpp::ParameterType::PARAMETER_STRING);
        if (held.get_type() != rclcpp::ParameterType::PARAMETER_NOT_SET) {
          topic = held.get<std::string>(); }
        create_publisher<std_msgs::msg::Bool>(topic, 1);""",
}
FACTORY = """
template<typename T, typename NodeT>
T asked(NodeT node, const std::string & name, const Descriptor & about = Descriptor()) {
  auto kind = rclcpp::ParameterValue{T{}}.get_type();
  auto held = node->declare_parameter(name, kind, about);
  if (held.get_type() == rclcpp::ParameterType::PARAMETER_NOT_SET) {
    throw rclcpp::exceptions::InvalidParameterValueException(name); }
  return held.template get<T>();
}
template<typename T, typename NodeT>
T asked(NodeT node, const std::string & name, const T & value, const Descriptor & about = {}) {
  return node->declare_parameter(name, value, about);
}
"""
MEMBERS = """
template<typename T> T own(const std::string & name, const Descriptor & about = Descriptor()) {
  return asked<T>(this, name, about); }
template<typename T>
T own(const std::string & name, const T & value, const Descriptor & about = Descriptor()) {
  return asked(this, name, value, about); }
"""
ASKS = """
try { create_publisher<std_msgs::msg::Bool>(own<std::string>("topic"), 1); }
catch (const std::exception &) { create_publisher<std_msgs::msg::Bool>("caught", 1); }
create_publisher<std_msgs::msg::Bool>(own<std::string>("other", "plain"), 1);
create_publisher<std_msgs::msg::Bool>(own("third", std::string("deduced")), 1);
"""


@pytest.mark.parametrize("how", READS)
def test_what_no_launch_sets_is_not_set(how):
    assert names(cpp(DECLARED + READS[how])) == ["/ns/default"]


@pytest.mark.parametrize("how", [how for how in READS if how != "a handler"])
def test_what_a_launch_sets_counts(how):
    found = names(cpp(DECLARED + READS[how], settings=settings(topic="given")))
    assert [name for name in found if name != "/ns/told"] == ["/ns/given"]


@pytest.mark.parametrize("how", ["a handler", "its kind"])
def test_without_a_launch_both_may_be(how):
    found = names(cpp(DECLARED + READS[how], parameters_complete=False))
    assert set(found) >= {"/ns/default"}


def test_a_factory_throws_for_a_parameter_that_is_not_set():
    found = names(cpp(ASKS, top=FACTORY, members=MEMBERS))
    assert found == ["/ns/caught", "/ns/plain", "/ns/deduced"]


def test_a_factory_returns_what_is_set():
    found = names(cpp(ASKS, top=FACTORY, members=MEMBERS, settings=settings(topic="given")))
    assert [name for name in found if name != "/ns/caught"] == [
        "/ns/given",
        "/ns/plain",
        "/ns/deduced",
    ]


PYTHON = {
    "a handler": """
try:
    topic = self.get_parameter('topic').value
except rclpy.exceptions.ParameterUninitializedException:
    topic = 'default'
""",
    "an alternative": """
other = rclpy.Parameter('topic', rclpy.Parameter.Type.STRING, 'default')
topic = self.get_parameter_or('topic', other).value
""",
}


@pytest.mark.parametrize("how", PYTHON)
@pytest.mark.parametrize("kind", ["rclpy.Parameter.Type.STRING", "Parameter.Type.STRING"])
def test_in_python_it_is_the_same(how, kind):
    top = "from rclpy.parameter import Parameter"
    body = f"self.declare_parameter('topic', {kind})" + PYTHON[how]
    body += "self.create_publisher(Bool, topic, 1)"
    assert names(python(body, top=top)) == ["/ns/default"]
    assert "/ns/given" in names(python(body, top=top, settings=settings(topic="given")))
