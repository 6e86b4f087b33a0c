"""Parameters of rclcpp's nodes: defaults, what a launch sets, what nobody knows."""

import pytest
from ros2_runs import UNLAUNCHED, cpp, names, only_declaration, run_text, settings

from rtron.vocabulary import Resolution, UnknownValue

TOPIC = "create_publisher<std_msgs::msg::Bool>({}, 1);"


@pytest.mark.parametrize(
    "read",
    [
        'declare_parameter("topic", "default")',
        'declare_parameter<std::string>("topic", "default")',
        'declare_parameter("topic", rclcpp::ParameterValue("default")).get<std::string>()',
    ],
)
@pytest.mark.parametrize(
    ("given", "expected"), [({}, "/ns/default"), ({"topic": "other"}, "/ns/other")]
)
def test_a_default_counts_where_the_launch_sets_nothing(read, given, expected):
    found = only_declaration(cpp(TOPIC.format(read), settings=settings(**given)))
    assert (found.name, found.resolution) == (expected, Resolution.PARAMETER)


@pytest.mark.parametrize(
    "read",
    [
        'auto t = get_parameter("topic").as_string();',
        'auto t = get_parameter("topic").get_value<std::string>();',
        'auto t = get_parameter("topic").get_parameter_value().get<std::string>();',
        'std::string t; get_parameter("topic", t);',
        'std::string t; get_parameter_or("topic", t, std::string("unused"));',
        'rclcpp::Parameter p; get_parameter("topic", p); auto t = p.as_string();',
        'auto t = get_parameters({"topic"})[0].as_string();',
        'std::string t; if (has_parameter("topic")) { t = get_parameter("topic").as_string(); }',
    ],
)
def test_a_declared_parameter_is_read_in_many_ways(read):
    body = f'declare_parameter("topic", "default"); {read} {TOPIC.format("t")}'
    assert names(cpp(body)) == ["/ns/default"]


def test_what_is_not_set_has_the_default_of_who_reads_it():
    body = 'std::string t; get_parameter_or("gone", t, std::string("mine"));' + TOPIC.format("t")
    assert names(cpp(body)) == ["/ns/mine"]


def test_a_parameter_that_is_set_by_the_program_holds_that():
    body = 'declare_parameter("topic", "a"); set_parameter(rclcpp::Parameter("topic", "b"));'
    assert names(cpp(body + TOPIC.format('get_parameter("topic").as_string()'))) == ["/ns/b"]


def test_parameters_may_be_declared_together():
    body = 'declare_parameters("motor", {{"left", "l"}, {"right", "r"}});'
    body += TOPIC.format('get_parameter("motor.right").as_string()')
    assert names(cpp(body)) == ["/ns/r"]


def test_options_of_a_node_override_its_parameters():
    body = """
    auto options = rclcpp::NodeOptions().append_parameter_override("topic", "from_options");
    auto other = std::make_shared<rclcpp::Node>("other", options.use_global_arguments(false));
    auto topic = other->declare_parameter("topic", "default");
    other->create_publisher<std_msgs::msg::Bool>(topic, 1);
    """
    assert names(cpp(body)) == ["/from_options"]


@pytest.mark.parametrize(
    ("node", "expected"),
    [
        ("/**", "/ns/set"),
        ("/ns/n", "/ns/set"),
        ("/*/n", "/ns/set"),
        ("/ns/*", "/ns/set"),
        ("/**/n", "/ns/set"),
        ("/n", "/ns/default"),
        ("/*", "/ns/default"),
        ("/ns/nn", "/ns/default"),
    ],
)
def test_a_parameter_file_speaks_of_the_nodes_that_fit_its_key(node, expected):
    body = TOPIC.format('declare_parameter("topic", "default")')
    assert names(cpp(body, settings=settings(node, topic="set"))) == [expected]


def test_the_last_setting_that_fits_counts():
    given = (*settings("/ns/n", topic="first"), *settings("/**", topic="second"))
    body = TOPIC.format('declare_parameter("topic", "default")')
    assert names(cpp(body, settings=given)) == ["/ns/second"]


@pytest.mark.parametrize("value", [UnknownValue("a command"), None])
def test_what_nobody_knows_is_named_after_the_parameter(value):
    given = settings(topic=value) if value else ()
    default = "rclcpp::ParameterType::PARAMETER_STRING"
    found = only_declaration(
        cpp(TOPIC.format(f'declare_parameter("topic", {default})'), settings=given)
    )
    assert (found.name, found.resolution) == ("/ns/{~topic}", Resolution.SYMBOLIC)


def test_a_branch_that_the_parameters_decide_is_decided():
    body = """
    if (declare_parameter("front", true)) { create_publisher<std_msgs::msg::Bool>("front", 1); }
    else { create_publisher<std_msgs::msg::Bool>("back", 1); }
    """
    assert names(cpp(body)) == ["/ns/front"]
    assert names(cpp(body, settings=settings(front=False))) == ["/ns/back"]
    assert names(cpp(body, **UNLAUNCHED)) == ["/front", "/back"]


LOOP = """
for (auto & name : declare_parameter("sensors", std::vector<std::string>{"left", "right"})) {
  create_subscription<std_msgs::msg::Bool>(
    declare_parameter(name + ".topic", name), 1, [](auto m) {});
}
"""


def test_a_list_of_the_launch_is_unrolled():
    given = settings(sensors=["up", "down"], up__topic="above")
    assert names(cpp(LOOP, settings=given)) == ["/ns/above", "/ns/down"]


def test_without_a_launch_one_more_item_stands_for_all_others():
    other = "/{~sensors[]}"
    found = names(cpp(LOOP, **UNLAUNCHED))
    assert found == ["/left", "/right", other, f"/{{~{other[1:]}.topic}}"]


def test_simulated_time_is_a_subscription():
    found = cpp("", settings=settings(use_sim_time=True)).declarations
    assert [(d.kind.value, d.implicit) for d in found if d.name == "/clock"] == [
        ("subscribe", True)
    ]
    assert not [d for d in cpp("").declarations if d.name == "/clock"]


OVERLOADS = """
namespace lib {
template<typename T> T get_or(rclcpp::Node * node, const std::string & name, const Descriptor & d) {
  return node->declare_parameter<T>(name); }
template<typename T> T get_or(rclcpp::Node * node, const std::string & name, const T & value) {
  return node->declare_parameter(name, value); }
}
"""


def test_of_two_templates_the_one_for_any_value_is_meant():
    body = TOPIC.format('lib::get_or(this, "topic", std::string("default"))')
    assert names(cpp(body, OVERLOADS)) == ["/ns/default"]


HELD = """
namespace lib { template<typename ParamsT> class Held {
public: ParamsT * get() { return &params_; }
protected: ParamsT params_; }; }
namespace app { struct Parameters { std::string topic; };
class Held : public lib::Held<Parameters> { public: explicit Held(rclcpp::Node * node) {
  params_.topic = node->declare_parameter("topic", "default"); } }; }
"""


def test_parameters_may_be_held_by_a_template_of_another_namespace():
    body = "auto held = std::make_shared<app::Held>(this);" + TOPIC.format("held->get()->topic")
    assert names(cpp(body, HELD)) == ["/ns/default"]


def test_a_list_of_pointers_holds_the_objects_themselves():
    top = "struct Layer { std::string name; void name_it(std::string n) { name = n; } };"
    body = """
    std::vector<std::shared_ptr<Layer>> layers;
    auto layer = std::make_shared<Layer>();
    layers.push_back(layer);
    layer->name_it("later");
    """
    found = cpp(body + TOPIC.format("layers[0]->name"), top)
    assert names(found) == ["/ns/later"]


def test_what_a_parameter_callback_changes_is_unknown_to_callbacks_alone():
    members = """
    std::string topic_ = "first";
    rcl_interfaces::msg::SetParametersResult on_set(std::vector<rclcpp::Parameter> ps) {
      topic_ = ps[0].as_string(); return {}; }
    void late() { create_publisher<std_msgs::msg::Int8>(topic_, 1); }
    """
    body = TOPIC.format("topic_")
    body += "handle = add_on_set_parameters_callback(std::bind(&N::on_set, this, _1));"
    body += "create_wall_timer(1s, std::bind(&N::late, this));"
    found = cpp(body, members=members)
    assert [d.name for d in found.declarations if d.type.endswith("Bool")] == ["/ns/first"]
    assert len([d for d in found.declarations if d.type.endswith("Int8")]) == 2


def test_a_program_without_an_end_is_bounded():
    text = 'int main() { rclcpp::Node n("n"); while (true) { n.declare_parameter("a", 1); } }'
    assert [node.name for node in run_text(text).nodes] == ["/ns/n"]


@pytest.mark.parametrize("automatic", [True, False])
def test_what_is_set_is_declared_where_the_options_say_so(automatic):
    body = f"""auto options = rclcpp::NodeOptions()
      .automatically_declare_parameters_from_overrides({str(automatic).lower()});
    auto other = std::make_shared<rclcpp::Node>(
      "other", options.append_parameter_override("own", 1).use_global_arguments(true));"""
    given = (*settings("/**", of_all=2), *settings("/nobody", never=3))
    found = {
        (p.name, p.value)
        for p in cpp(body, settings=given, has_launch_name=False).parameters
        if p.node.endswith("/other")
    }
    assert ({("own", 1), ("of_all", 2)} <= found) is automatic
    assert "never" not in {name for name, _ in found}


DECLARED = """declare_parameter("in.a.topic", "first"); declare_parameter("in.b", "second");
  declare_parameter("inner", "third");"""


@pytest.mark.parametrize(
    ("prefixes", "depth", "expected"),
    [
        ('{"in"}', 0, ["in.a.topic", "in.b"]),
        ('{"in"}', 10, ["in.a.topic", "in.b"]),
        ('{"in"}', 1, ["in.b"]),
        ('{"in.a", "inner"}', 1, ["in.a.topic", "inner"]),
        ("{}", 1, ["inner", "use_sim_time"]),
    ],
)
def test_a_node_lists_its_parameters(prefixes, depth, expected):
    """As a real node does (rclcpp: NodeParameters::list_parameters)."""
    body = f"""{DECLARED}
    auto list = list_parameters({prefixes}, {depth});
    for (auto name : list.names) {{ {TOPIC.format("name")} }}"""
    assert names(cpp(body)) == [f"/ns/{name}" for name in expected]


MUX = """auto list = list_parameters({"topics"}, 10);
  for (const auto & prefix : list.prefixes) {
    std::string topic;
    get_parameter(prefix + ".topic", topic);
    create_subscription<std_msgs::msg::Bool>(topic, 1, [](auto m) {}); }"""
AUTOMATIC = "rclcpp::NodeOptions().automatically_declare_parameters_from_overrides(true)"
MUXED = f"""#include <rclcpp/rclcpp.hpp>
class N : public rclcpp::Node {{ public: N() : Node("written", {AUTOMATIC}) {{ {MUX} }} }};
int main() {{ rclcpp::spin(std::make_shared<N>()); }}"""


def test_what_a_launch_sets_is_listed_where_the_node_declares_it():
    given = settings(topics__joy__topic="joy_vel", topics__nav__topic="nav_vel", other="x")
    assert names(run_text(MUXED, settings=given)) == ["/ns/joy_vel", "/ns/nav_vel"]
    assert names(cpp(MUX, settings=given)) == []


def test_without_a_launch_the_list_may_have_more():
    assert names(run_text(MUXED, **UNLAUNCHED)) == ["/{~{prefix}.topic}"]
