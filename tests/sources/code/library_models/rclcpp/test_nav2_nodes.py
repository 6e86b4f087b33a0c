"""Nodes that derive from nav2_util's, where its source is not here."""

import pytest
from ros2_runs import explicit_declarations, implicit_declarations, run_text, settings

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
