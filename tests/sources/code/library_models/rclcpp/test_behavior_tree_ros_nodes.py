"""Tree nodes that join ROS: those of nav2_behavior_tree and BehaviorTree.ROS2, without source."""

from pathlib import Path

import pytest
from file_tree import write
from ros2_runs import UNLAUNCHED, explicit_declarations, site

from rtron.sources.code.program_runner import run_cpp
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.static.ros2.app import read_ros2_workspace

NAV2 = """#include "nav2_behavior_tree/bt_action_node.hpp"
class Dock : public nav2_behavior_tree::BtActionNode<dock_msgs::action::Dock> { public:
  Dock(const std::string & tag, const std::string & action, const BT::NodeConfiguration & conf)
  : BtActionNode<dock_msgs::action::Dock>(tag, action, conf) {} };
class Stop : public nav2_behavior_tree::BtCancelActionNode<dock_msgs::action::Dock> { public:
  Stop(const std::string & tag, const std::string & action, const BT::NodeConfiguration & conf)
  : nav2_behavior_tree::BtCancelActionNode<dock_msgs::action::Dock>(tag, action, conf) {} };
class Clear : public nav2_behavior_tree::BtServiceNode<std_srvs::srv::Empty> { public:
  Clear(const std::string & name, const BT::NodeConfiguration & conf)
  : nav2_behavior_tree::BtServiceNode<std_srvs::srv::Empty>(name, conf) {}
  void on_tick() override { node_->create_publisher<std_msgs::msg::Bool>("ticked", 1); }
  static BT::PortsList providedPorts() { return providedBasicPorts({
    BT::InputPort<std::string>("service_name", "clear_all", "what to call")}); } };
BT_REGISTER_NODES(factory) {
  BT::NodeBuilder dock = [](const std::string & name, const BT::NodeConfiguration & config) {
    return std::make_unique<Dock>(name, "dock", config); };
  factory.registerBuilder<Dock>("Dock", dock);
  factory.registerBuilder<Stop>("Stop", [](auto & name, auto & config) {
    return std::make_unique<Stop>(name, "dock", config); });
  factory.registerNodeType<Clear>("Clear");
}
"""
PLAIN = """#include "behaviortree_ros2/bt_action_node.hpp"
#include "behaviortree_ros2/plugins.hpp"
class Dock : public BT::RosActionNode<dock_msgs::action::Dock> { public:
  Dock(const std::string & name, const BT::NodeConfig & conf, const BT::RosNodeParams & params)
  : BT::RosActionNode<dock_msgs::action::Dock>(name, conf, params) {} };
class Clear : public BT::RosServiceNode<std_srvs::srv::Empty> { public:
  using BT::RosServiceNode<std_srvs::srv::Empty>::RosServiceNode; };
class Say : public BT::RosTopicPubNode<std_msgs::msg::String> { public:
  Say(const std::string & name, const BT::NodeConfig & conf, const BT::RosNodeParams & params)
  : RosTopicPubNode<std_msgs::msg::String>(name, conf, params) {} };
class Hear : public BT::RosTopicSubNode<std_msgs::msg::Bool> { public:
  Hear(const std::string & name, const BT::NodeConfig & conf, const BT::RosNodeParams & params)
  : RosTopicSubNode<std_msgs::msg::Bool>(name, conf, params) {} };
"""
ENGINE = """%s
int main() {
  auto node = std::make_shared<rclcpp::Node>("engine");
  BT::BehaviorTreeFactory factory;
  auto blackboard = BT::Blackboard::create();
  blackboard->set<rclcpp::Node::SharedPtr>("node", node);
  %s
  auto path = ament_index_cpp::get_package_share_directory("trees") + "/main.xml";
  auto tree = factory.createTreeFromFile(path, blackboard);
  rclcpp::spin(node);
}
"""
REGISTERED = """BT::RosNodeParams params;
  params.nh = node;
  params.default_port_value = "dock";
  factory.registerNodeType<Dock>("Dock", params);
  factory.registerNodeType<Clear>("Clear", BT::RosNodeParams(node, "clear"));
  factory.registerNodeType<Say>("Say", params);
  factory.registerNodeType<Hear>("Hear", params);"""


def run(tmp_path: Path, engine: str, tree: str, library: str = "", **given):
    files = {
        "package.xml": "<package><name>trees</name></package>",
        "CMakeLists.txt": "add_executable(engine engine.cpp)\nadd_library(dock_nodes nodes.cpp)\n",
        "engine.cpp": engine,
        "nodes.cpp": library,
        "main.xml": f'<root><BehaviorTree ID="M"><Sequence>{tree}</Sequence></BehaviorTree></root>',
    }
    write(tmp_path, files)
    found = read_ros2_workspace([tmp_path])
    sources = found.executable("trees", "engine").sources
    return run_cpp(sources, site(**given), WorkspaceSources(found))


LOADED = ENGINE % ("", 'factory.registerFromPlugin(BT::SharedLibrary::getOSName("dock_nodes"));')
DOCK, EMPTY = "dock_msgs/action/Dock", "std_srvs/srv/Empty"


@pytest.mark.parametrize(
    ("tree", "expected"),
    [
        ("<Dock/>", f"action_client /ns/dock {DOCK}"),
        ('<Dock server_name="other"/>', f"action_client /ns/other {DOCK}"),
        ('<Dock server_name="{who}"/>', f"action_client /ns/{{who}} {DOCK}"),
        ('<Stop server_name="/far/dock"/>', f"action_client /far/dock {DOCK}"),
        ('<Clear service_name="clear"/>', f"service_client /ns/clear {EMPTY}"),
        ("<Clear/>", f"service_client /ns/clear_all {EMPTY}"),
    ],
)
def test_the_tree_nodes_of_nav2_have_a_client(tmp_path, tree, expected):
    found = run(tmp_path, LOADED, tree, NAV2)
    declared = [one for one in explicit_declarations(found) if "ticked" not in one]
    assert declared == [expected]
    (made,) = [d for d in found.declarations if d.type in {DOCK, EMPTY}]
    assert made.evidence[0].file.endswith("nodes.cpp")


def test_without_a_launch_the_tree_nodes_of_nav2_have_their_defaults(tmp_path):
    found = run(tmp_path, LOADED, "", NAV2, **UNLAUNCHED)
    declared = set(explicit_declarations(found))
    assert {f"action_client /dock {DOCK}", f"service_client /clear_all {EMPTY}"} <= declared
    assert "publish /ticked std_msgs/msg/Bool" in declared


def test_a_tree_node_without_a_node_in_its_blackboard_is_noted(tmp_path):
    engine = LOADED.replace('"node", node', '"other", node')
    found = run(tmp_path, engine, "<Dock/>", NAV2)
    assert "action_client(dock)" in [note.what for note in found.unresolved]


@pytest.mark.parametrize(
    ("tree", "expected"),
    [
        ("<Dock/>", f"action_client /ns/dock {DOCK}"),
        ('<Dock action_name="other"/>', f"action_client /ns/other {DOCK}"),
        ('<Dock action_name="__default__placeholder__"/>', f"action_client /ns/dock {DOCK}"),
        ('<Dock action_name="{who}"/>', f"action_client /ns/{{who}} {DOCK}"),
        ("<Clear/>", f"service_client /ns/clear {EMPTY}"),
        ('<Say topic_name="/said"/>', "publish /said std_msgs/msg/String"),
        ('<Hear topic_name="heard"/>', "subscribe /ns/heard std_msgs/msg/Bool"),
    ],
)
def test_the_tree_nodes_of_behavior_tree_ros2(tmp_path, tree, expected):
    found = run(tmp_path, ENGINE % (PLAIN, REGISTERED), tree)
    assert explicit_declarations(found) == [expected]
    assert all(d.qos.depth == 1 for d in found.declarations if d.name in {"/said", "/ns/heard"})


def test_a_plugin_of_behavior_tree_ros2_registers_its_node(tmp_path):
    registered = """BT::RosNodeParams params{node, "dock"};
      RegisterRosNode(factory, "libdock_nodes.so", params);"""
    library = f'{PLAIN}CreateRosNodePlugin(Dock, "Dock");\n'
    found = run(tmp_path, ENGINE % ("", registered), "<Dock/>", library)
    assert explicit_declarations(found) == [f"action_client /ns/dock {DOCK}"]
