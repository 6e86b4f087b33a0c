"""Nodes that derive from nav2_util's, where its source is not here."""

import pytest
from ros2_runs import cpp, explicit_declarations, implicit_declarations, names, run_text, settings

NODE = """#include "nav2_util/lifecycle_node.hpp"
class N : public %s::LifecycleNode { public:
  N(const rclcpp::NodeOptions & options) : %s::LifecycleNode("mine", "", options) {
    add_parameter("topic", rclcpp::ParameterValue("told")); }
  nav2_util::CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
    %s
    return nav2_util::CallbackReturn::SUCCESS; }
  nav2_util::CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
    createBond();
    return nav2_util::CallbackReturn::SUCCESS; }
  void run() {}
};
int main(int argc, char ** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<N>(rclcpp::NodeOptions())->get_node_base_interface());
}
"""
DO, EMPTY = "a_msgs/action/Do", "std_srvs/srv/Empty"


def run(body, namespace="nav2_util", **given):
    return run_text(NODE % (namespace, namespace, body), **given)


@pytest.mark.parametrize("namespace", ["nav2_util", "nav2"])
def test_its_node_is_a_lifecycle_node_with_a_bond(namespace):
    found = run('create_publisher<std_msgs::msg::Bool>("p", 1);', namespace)
    assert [node.name for node in found.nodes] == ["/ns/n"]
    assert explicit_declarations(found) == ["publish /ns/p std_msgs/msg/Bool"]
    implicit = implicit_declarations(found)
    assert {"service /ns/n/change_state", "publish /ns/bond", "subscribe /ns/bond"} <= implicit


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('nav2_util::ServiceClient<std_srvs::srv::Empty> c("s", shared_from_this());',
         [f"service_client /ns/s {EMPTY}"]),
        ('c_ = std::make_unique<nav2_util::ServiceClient<std_srvs::srv::Empty>>("/s", node);',
         []),
        ('nav2_util::LifecycleServiceClient c("amcl", shared_from_this());',
         ["service_client /ns/amcl/change_state lifecycle_msgs/srv/ChangeState",
          "service_client /ns/amcl/get_state lifecycle_msgs/srv/GetState"]),
        ("""s_ = std::make_unique<nav2_util::SimpleActionServer<a_msgs::action::Do>>(
           shared_from_this(), "do", std::bind(&N::run, this));""",
         [f"action_server /ns/do {DO}"]),
        ("""s_ = std::make_unique<nav2_util::SimpleActionServer<a_msgs::action::Do>>(
           get_node_base_interface(), get_node_clock_interface(), get_node_logging_interface(),
           get_node_waitables_interface(), "do", std::bind(&N::run, this));""",
         [f"action_server /ns/do {DO}"]),
        ('s_ = create_action_server<a_msgs::action::Do>("do", std::bind(&N::run, this));',
         [f"action_server /ns/do {DO}"]),
    ],
)  # fmt: skip
def test_its_clients_and_servers(body, expected):
    found = run(body)
    assert explicit_declarations(found) == expected
    assert ("service_client(/s)" in [note.what for note in found.unresolved]) is not expected


DECLARED = [
    'auto t = get_parameter("topic").as_string();',
    """nav2_util::declare_parameter_if_not_declared(
      shared_from_this(), "topic", rclcpp::ParameterValue("other"));
    std::string t; get_parameter("topic", t);""",
    'auto t = declare_or_get_parameter("topic", std::string("other"));',
]


@pytest.mark.parametrize("declared", DECLARED)
def test_its_parameters_decide_names(declared):
    body = f"{declared} create_publisher<std_msgs::msg::Bool>(t, 1);"
    assert explicit_declarations(run(body)) == ["publish /ns/told std_msgs/msg/Bool"]
    given = run(body, settings=settings(topic="given"))
    assert explicit_declarations(given) == ["publish /ns/given std_msgs/msg/Bool"]


def test_a_plugin_has_its_type_in_a_parameter():
    body = """auto t = nav2_util::get_plugin_type_param(shared_from_this(), "Path");
    create_publisher<std_msgs::msg::Bool>(t, 1);"""
    given = run(body, settings=settings(Path__plugin="straight"))
    assert explicit_declarations(given) == ["publish /ns/straight std_msgs/msg/Bool"]


def test_code_that_is_not_here_and_gets_a_node_is_noted():
    found = run("arm::planning::Group group(shared_from_this(), name);")
    notes = {note.what: note for note in found.unresolved}
    assert "its code is not here, and it gets the node" in notes["arm::planning::Group()"].why
    assert notes["arm::planning::Group()"].evidence[0].line == 6


CLIENT = "nav2_util::ServiceClient<std_srvs::srv::SetBool>"


@pytest.mark.parametrize("space", ["nav2_util", "nav2"])
def test_a_service_client(space):
    client = CLIENT.replace("nav2_util", space)
    interface = cpp(f'auto c = std::make_shared<{client}>("go", shared_from_this());')
    assert explicit_declarations(interface) == ["service_client /ns/go std_srvs/srv/SetBool"]


def test_one_that_a_callback_makes_in_a_function_without_another_call_of_rclcpp():
    members = f'void later() {{ c_ = std::make_shared<{CLIENT}>("go", shared_from_this()); }}'
    members += f"std::shared_ptr<{CLIENT}> c_;"
    interface = cpp("create_wall_timer(0s, [this]() { later(); });", members=members)
    assert names(interface) == ["/ns/go"]


def test_an_action_server_and_what_its_callback_makes():
    server = "nav2_util::SimpleActionServer<nav2_msgs::action::Spin>"
    members = 'void run() { create_publisher<std_msgs::msg::Bool>("made", 1); }'
    body = f'auto s = std::make_unique<{server}>(this, "spin", [this]() {{ run(); }});'
    assert names(cpp(body, members=members)) == ["/ns/spin", "/ns/made"]


def test_what_gets_a_node_and_is_not_here_is_noted():
    interface = cpp("auto d = std::make_shared<vendor::Driver>(shared_from_this());")
    assert [note.what for note in interface.unresolved] == ["vendor::Driver()"]


def test_what_runs_a_node_is_not_noted():
    interface = cpp("rclcpp::spin(shared_from_this()); executor_.add_node(shared_from_this());")
    assert interface.unresolved == ()
