"""Names of rclcpp's nodes and of what they declare (docs.ros.org: names, namespaces)."""

import pytest
from ros2_runs import CPP, UNLAUNCHED, cpp, explicit_declarations, names, python, run_text

from rtron.sources.declaration import ComponentLoading

ALL = """
create_publisher<std_msgs::msg::Bool>("rel", 1);
create_publisher<std_msgs::msg::Bool>("~/private", 1);
create_publisher<std_msgs::msg::Bool>("/absolute", 1);
"""


def test_names_resolve_at_the_node_that_the_launch_names():
    assert names(cpp(ALL)) == ["/ns/rel", "/ns/n/private", "/absolute"]


def test_without_a_launch_the_source_names_the_node():
    found = cpp(ALL, **UNLAUNCHED)
    assert names(found) == ["/rel", "/written/private", "/absolute"]
    assert [node.name for node in found.nodes] == ["/written"]


def test_a_namespace_of_the_launch_counts_beside_the_name_of_the_source():
    found = cpp(ALL, name="/robot/exe", has_launch_name=False)
    assert names(found) == ["/robot/rel", "/robot/written/private", "/absolute"]


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("std::string(get_name())", "/ns/n"),
        ('std::string(get_namespace()) + "/x"', "/ns/x"),
        ("get_fully_qualified_name()", "/ns/n"),
        ('std::string(get_name()) + "/" + "x"', "/ns/n/x"),
        ('std::string("{node}/x")', "/ns/n/x"),
        ('get_node_topics_interface()->resolve_topic_name("x")', "/ns/x"),
        ('get_node_topics_interface()->resolve_topic_name("~/x")', "/ns/n/x"),
        ('get_node_services_interface()->resolve_service_name("/x")', "/x"),
    ],
)
def test_a_nodes_own_names_are_known(expression, expected):
    assert names(cpp(f"create_publisher<std_msgs::msg::Bool>({expression}, 1);")) == [expected]


@pytest.mark.parametrize("question", ["count_publishers", "get_subscriptions_info_by_topic"])
def test_who_asks_the_graph_for_a_name_does_not_change_it(question):
    body = f"""
    std::string name = "x";
    auto found = {question}(name);
    create_publisher<std_msgs::msg::Bool>(name, 1);
    """
    assert names(cpp(body)) == ["/ns/x"]


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ('printf("%s", topic);', ["/a"]),
        ('std::fprintf(stderr, "%s", topic.c_str());', ["/a"]),
        ("if (strlen(topic) > 3) { puts(topic); }", ["/a"]),
        ("std::remove(topic.begin(), topic.end(), 'x');", ["/a", "/ns/{topic}"]),
        ("improve(topic);", ["/a", "/ns/{topic}"]),
    ],
)
def test_what_prints_a_text_leaves_it_as_it_is(call, expected):
    made = "create_publisher<std_msgs::msg::Bool>(topic, 1);"
    assert names(cpp(f'std::string topic = "/a"; {call} {made}')) == expected


MAKING = "{}topic) {{ improve(topic); create_publisher<std_msgs::msg::Bool>(topic, 1); }}"


@pytest.mark.parametrize(
    ("parameter", "fixed"),
    [
        ("const std::string & ", True),
        ("const std::string ", True),
        ("std::string const & ", True),
        ("const char * const ", True),
        ("const char * const & ", True),
        ("std::string ", False),
        ("std::string & ", False),
        ("const char * ", False),
        ("const char *& ", False),
    ],
)
def test_what_is_constant_stays_as_it_is_whoever_is_given_it(parameter, fixed):
    expected = ["/a"] if fixed else ["/a", "/ns/{topic}"]
    members = f"void make({MAKING.format(parameter)}"
    assert names(cpp('std::string topic = "/a"; make(topic);', members=members)) == expected
    lambda_ = f"auto make = [this]({MAKING.format(parameter)};"
    assert names(cpp(f'{lambda_} std::string topic = "/a"; make(topic);')) == expected


@pytest.mark.parametrize(
    ("declared", "fixed"),
    [
        ("const std::string", True),
        ("static const char * const", True),
        ("constexpr const char *", True),
        ("constexpr auto", True),
        ("std::string", False),
        ("static const char *", False),
    ],
)
def test_a_constant_variable_stays_as_it_is_whoever_is_given_it(declared, fixed):
    expected = ["/a"] if fixed else ["/a", "/ns/{T}"]
    made = "improve(T); create_publisher<std_msgs::msg::Bool>(T, 1);"
    assert names(cpp(f'{declared} T = "/a"; {made}')) == expected
    assert names(cpp(made, f'{declared} T = "/a";')) == expected
    later = f"std::thread t([&]() {{ {made} }});"
    assert names(cpp(f'{declared} T = "/a"; {later}')) == expected


GIVEN = "improve(T); create_publisher<std_msgs::msg::Bool>(T, 1);"


@pytest.mark.parametrize(
    ("declared", "inherited", "fixed"),
    [
        ("const std::string", "", True),
        ("const std::string", "const std::string T;", True),
        ("const std::string", "std::string T;", False),
        ("std::string", "", False),
        ("const char *", "", False),
    ],
)
def test_a_constant_member_stays_as_it_is_whoever_is_given_it(declared, inherited, fixed):
    top = f"struct Base {{ {inherited} }};"
    text = CPP.format(top=top, body=GIVEN, members=f'{declared} T = "/a";')
    found = run_text(text.replace("class N : public", "class N : public Base, public"))
    assert names(found) == (["/a"] if fixed else ["/a", "/ns/{T}"])


@pytest.mark.parametrize(
    ("body", "top", "members"),
    [
        (f'std::string T("a"); {{ const std::string T("b"); }} {GIVEN}', "", ""),
        (f'{{ const std::string T("b"); }} std::string T("a"); {GIVEN}', "", ""),
        (f'{{ const std::string T("b"); }} {GIVEN}', 'std::string T("a");', ""),
        (f'{{ const std::string T("b"); }} {GIVEN}', "", 'std::string T = "a";'),
        (f'std::string T("a"); [&]() {{ {{ const std::string T("b"); }} {GIVEN} }}();', "", ""),
        (f'for (std::string T : {{"a", "b"}}) {{ {GIVEN} }}', 'const std::string T("b");', ""),
        (f'{{ const std::string T("b"); }} for (std::string T : {{"a"}}) {{ {GIVEN} }}', "", ""),
        (f'{{ const int T = 1; }} auto [T, n] = std::make_pair("a", 1); {GIVEN}', "", ""),
    ],
)
def test_a_constant_says_nothing_of_another_variable_of_its_name(body, top, members):
    assert "/ns/{T}" in names(cpp(body, top, members))


def test_a_variable_that_hides_a_constant_leaves_it_as_it_is():
    hiding = 'auto f = [&]() { for (std::string T : {"a", "b"}) {} }; f();'
    body = f'const std::string T("c"); {hiding} {GIVEN}'
    assert names(cpp(body)) == ["/ns/c"]


def test_constants_of_one_name_in_several_blocks_stay_as_they_are():
    body = f'{{ const std::string T("a"); {GIVEN} }} {{ const std::string T("b"); {GIVEN} }}'
    assert names(cpp(body, 'const std::string T("c");')) == ["/ns/a", "/ns/b"]


PICKED = """#include <rclcpp/rclcpp.hpp>
static const char * FLAG = "--topic";
int main(int argc, char ** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("n");
  std::string topic("usual");
  if (rcutils_cli_option_exist(argv, argv + argc, FLAG)) {
    topic = rcutils_cli_get_option(argv, argv + argc, FLAG);
  }
  auto out = node->create_publisher<std_msgs::msg::Bool>(topic, 1);
}
"""


@pytest.mark.parametrize(
    ("args", "expected"),
    [((), "/ns/usual"), (("x", "--topic", "own"), "/ns/own"), (("--topics", "b"), "/ns/usual")],
)
def test_an_option_of_the_command_line_names_a_topic(args, expected):
    assert names(run_text(PICKED, args=args)) == [expected]


OPTIONS = """
auto options = rclcpp::NodeOptions().arguments({
  "--ros-args", "-r", std::string("__ns:=/") + get_name(), "-r", "__node:=second",
  "-r", "scan:=scan_filtered", "-p", "use_sim_time:=true"});
auto second = std::make_shared<rclcpp::Node>("any", options);
second->create_publisher<std_msgs::msg::Bool>("rel", 1);
"""


def test_a_nodes_own_arguments_count_before_the_launchs():
    found = cpp(OPTIONS)
    assert names(found) == ["/n/rel"]
    assert [node.name for node in found.nodes] == ["/ns/n", "/n/second"]
    assert found.nodes[1].remaps == (("scan", "scan_filtered"),)
    assert {d.node for d in found.declarations if d.name == "/clock"} == {"/n/second"}


def test_a_node_that_takes_no_global_arguments_keeps_its_name():
    body = """
    auto options = rclcpp::NodeOptions().use_global_arguments(false);
    auto own = std::make_shared<rclcpp::Node>("own", "there", options);
    own->create_publisher<std_msgs::msg::Bool>("rel", 1);
    """
    found = cpp(body)
    assert names(found) == ["/there/rel"]
    assert [node.uses_global_arguments for node in found.nodes] == [True, False]


COMPONENT = """#include <rclcpp_components/register_node_macro.hpp>
namespace app {
class Driver : public rclcpp::Node {
public:
  explicit Driver(const rclcpp::NodeOptions & options) : Node("driver", options) {
    create_subscription<sensor_msgs::msg::Joy>(
      "joy", rclcpp::SensorDataQoS(), [this](sensor_msgs::msg::Joy::ConstSharedPtr) {});
  }
};
}
RCLCPP_COMPONENTS_REGISTER_NODE(app::Driver)
"""


def test_an_executable_of_a_component_makes_it_with_the_arguments_of_the_process():
    found = run_text(COMPONENT, cls="app::Driver", name="/cell/one")
    assert explicit_declarations(found) == ["subscribe /cell/joy sensor_msgs/msg/Joy"]


def test_a_component_is_made_with_the_options_of_its_container():
    words = ("--ros-args", "-r", "__node:=one", "-r", "__ns:=/cell", "-r", "joy:=pad")
    loading = ComponentLoading(container="/far/box")
    found = run_text(COMPONENT, cls="app::Driver", name="/cell/one", args=words, loading=loading)
    assert explicit_declarations(found) == ["subscribe /cell/joy sensor_msgs/msg/Joy"]
    (node,) = found.nodes
    assert (node.name, node.remaps, node.uses_global_arguments) == (
        "/cell/one",
        (("joy", "pad"),),
        False,
    )


RULES = """
auto options = rclcpp::NodeOptions().arguments({
  "--ros-args", "-r", "other:__node:=never", "-r", "any:__node:=first", "-r", "__node:=second",
  "-r", "any:__ns:=/old", "-r", "first:__ns:=/new", "-r", "first:a:=b"});
auto made = std::make_shared<rclcpp::Node>("any", options);
"""


def test_the_first_rule_for_a_nodes_name_counts():
    node = cpp(RULES).nodes[1]
    assert (node.name, node.remaps) == ("/new/first", (("first:a", "b"),))


def test_the_arguments_of_a_process_may_name_one_of_its_nodes():
    rules = ("--ros-args", "-r", "written:__node:=base", "-r", "left:__node:=wing")
    body = 'auto left = std::make_shared<rclcpp::Node>("left");'
    assert [n.name for n in cpp(body, args=rules, has_launch_name=False).nodes] == [
        "/ns/base",
        "/ns/wing",
    ]


def test_parameters_given_to_the_constructor_count_over_its_arguments():
    body = """
    auto options = rclcpp::NodeOptions().arguments({"--ros-args", "-p", "a:=low", "-p", "b:=low"})
      .parameter_overrides({rclcpp::Parameter("a", "high")});
    auto made = std::make_shared<rclcpp::Node>("made", "", options);
    made->create_publisher<std_msgs::msg::Bool>(made->declare_parameter<std::string>("a", "x"), 1);
    made->create_publisher<std_msgs::msg::Bool>(made->declare_parameter<std::string>("b", "x"), 1);
    """
    assert names(cpp(body)) == ["/ns/high", "/ns/low"]


def test_an_override_is_found_by_a_name_that_a_parameter_gives():
    body = """
    auto options = rclcpp::NodeOptions().parameter_overrides(
      {rclcpp::Parameter("kind", "left"), rclcpp::Parameter("left.topic", "there")});
    auto made = std::make_shared<rclcpp::Node>("made", "", options);
    auto kind = made->declare_parameter<std::string>("kind", "none");
    made->create_publisher<std_msgs::msg::Bool>(
      made->declare_parameter<std::string>(kind + ".topic", "here"), 1);
    """
    assert names(cpp(body)) == ["/ns/there"]


def test_a_component_that_is_not_there_is_noted():
    notes = run_text(COMPONENT, cls="app::Gone").unresolved
    assert "component app::Gone" in [note.what for note in notes]


def test_a_base_class_hands_its_constructor_on():
    top = "class Base : public rclcpp::Node { public: using rclcpp::Node::Node; };"
    text = (
        top
        + """
    class Mine : public Base { public: Mine() : Base("mine", "far") {
      create_publisher<std_msgs::msg::Bool>("rel", 1); } };
    int main() { rclcpp::spin(std::make_shared<Mine>()); }
    """
    )
    assert names(run_text(text, **UNLAUNCHED)) == ["/far/rel"]


def test_a_constructor_that_names_its_own_class_in_full_delegates():
    text = """
    namespace lib { class Node : public rclcpp::Node {
    public:
      Node(const std::string & name, const std::string & ns) : rclcpp::Node(name, ns) {}
      explicit Node(const std::string & name) : lib::Node(name, "deep") {}
    }; }
    class Mine : public lib::Node { public: Mine() : lib::Node("mine") {
      create_publisher<std_msgs::msg::Bool>("~/rel", 1); } };
    int main() { rclcpp::spin(std::make_shared<Mine>()); }
    """
    assert names(run_text(text, **UNLAUNCHED)) == ["/deep/mine/rel"]


@pytest.mark.parametrize(
    "body",
    [
        'create_publisher<std_msgs::msg::Bool>(declare_parameter("topic", ""), 1);',
        "std::string name; create_publisher<std_msgs::msg::Bool>(name, 1);",
        'std::string name; create_publisher<std_msgs::msg::Bool>("/" + name, 1);',
    ],
)
def test_an_empty_name_is_a_note_and_no_endpoint(body):
    found = cpp(body)
    assert names(found) == []
    assert [(note.what, note.why) for note in found.unresolved] == [
        ("publish of type std_msgs/msg/Bool", "its name is empty, which ROS refuses")
    ]


def test_an_empty_name_of_python_is_a_note_and_no_endpoint():
    found = python("self.create_subscription(Bool, '', print, 1)")
    assert names(found) == []
    assert [note.what for note in found.unresolved] == ["subscribe of type std_msgs/msg/Bool"]
