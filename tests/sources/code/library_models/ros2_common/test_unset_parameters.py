"""Parameters that are declared by their type alone, and that a launch may leave unset (rclcpp)."""

import pytest
from ros2_runs import cpp, names, python, settings

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
