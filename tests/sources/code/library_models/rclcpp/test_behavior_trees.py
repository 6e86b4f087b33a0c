"""Behaviour trees: which of their nodes are made, with what in their ports (behaviortree.dev)."""

from pathlib import Path

import pytest
from file_tree import write
from ros2_runs import UNLAUNCHED, names, site

from rtron.sources.code.library_models.rclcpp.behavior_tree_xml import MAX_NODES
from rtron.sources.code.program_runner import run_cpp
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.static.ros2.app import read_ros2_workspace

TREE = """
namespace tree {
class Wait : public BT::ConditionNode { public:
  Wait(const std::string & name, const BT::NodeConfiguration & config)
  : BT::ConditionNode(name, config) {
    auto node = this->config().blackboard->get<rclcpp::Node::SharedPtr>("node");
    std::string topic, extra = "plain";
    getInput("topic", topic);
    if (getInput("extra", extra)) { node->create_publisher<std_msgs::msg::Bool>("told", 1); }
    node->create_subscription<std_msgs::msg::Bool>(topic, 1, [](auto m) {});
    node->create_publisher<std_msgs::msg::Bool>(extra, 1);
  }
  static BT::PortsList providedPorts() {
    return { BT::InputPort<std::string>("topic", "wait_for", "what to wait for"),
      BT::InputPort<std::string>("extra", "no default") }; } };
class Never : public Wait { public: using Wait::Wait; };
}
BT_REGISTER_NODES(factory) {
  factory.registerNodeType<tree::Wait>("Wait");
  factory.registerNodeType<tree::Never>("Never");
}
"""
ENGINE = """
class Engine : public rclcpp::Node { public:
  Engine() : Node("engine") {
    factory_.registerFromPlugin(BT::SharedLibrary::getOSName("wait_node"));
    blackboard_ = BT::Blackboard::create();
    blackboard_->set<rclcpp::Node::SharedPtr>("node", shared_from_this());
    %s
  }
  BT::BehaviorTreeFactory factory_;
  BT::Blackboard::Ptr blackboard_; };
int main() { rclcpp::spin(std::make_shared<Engine>()); }
"""


LOADS = """
    auto path = ament_index_cpp::get_package_share_directory("trees") + "/main.xml";
    factory_.registerBehaviorTreeFromFile(path);
    tree_ = factory_.createTree("Main", blackboard_);"""
AT_ONCE = """
    tree_ = factory_.createTreeFromFile(
      ament_index_cpp::get_package_share_path("trees") / "main.xml", blackboard_);"""
PATH = 'ament_index_cpp::get_package_share_directory("trees") + "/main.xml"'
FROM_TEXT = f"""
    std::ifstream file({PATH});
    if (!file.good()) {{ create_publisher<std_msgs::msg::Bool>("lost", 1); return; }}
    auto xml = std::string(
      std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    tree_ = factory_.createTreeFromText(xml, blackboard_);"""
FROM_BUFFER = f"""
    std::ifstream file;
    file.open({PATH});
    std::stringstream buffer;
    buffer << file.rdbuf();
    factory_.registerBehaviorTreeFromText(buffer.str());
    tree_ = factory_.createTree("Main", blackboard_);"""
XML = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Other"><Never topic="never"/></BehaviorTree>
  <BehaviorTree ID="Main">
    <Sequence name="Wait"><Wait topic="first"/><Wait topic="first" name="again"/>
      <Condition ID="Wait" extra="second"/><SubTree ID="Inner"/><SubTree ID="Main"/>
      <Hidden/><Inverter><Wait topic="{goal}"/></Inverter></Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Inner"><Wait topic="inner"/></BehaviorTree>
</root>"""


def engine(tmp_path: Path, loads: str = LOADS, xml: str = XML, library: str = TREE, **given):
    cmake = "project(trees)\nadd_library(wait_node wait.cpp)\nadd_executable(engine engine.cpp)\n"
    files = {
        "CMakeLists.txt": cmake,
        "wait.cpp": library,
        "engine.cpp": ENGINE % loads,
        "main.xml": xml,
    }
    write(tmp_path, {"package.xml": "<package><name>trees</name></package>", **files})
    found = read_ros2_workspace([tmp_path])
    sources = found.executable("trees", "engine").sources
    return run_cpp(sources, site(**given), WorkspaceSources(found))


def test_without_a_launch_every_registered_node_is_made_with_its_ports_defaults(tmp_path):
    assert "/wait_for" in names(engine(tmp_path, **UNLAUNCHED))


@pytest.mark.parametrize("loads", [LOADS, AT_ONCE, FROM_TEXT, FROM_BUFFER])
def test_with_a_launch_the_nodes_of_the_tree_are_made_with_its_ports(tmp_path, loads):
    found = engine(tmp_path, loads)
    subscribed = [d.name for d in found.declarations if d.kind.value == "subscribe"]
    assert [name for name in subscribed if name != "/parameter_events"] == [
        "/ns/first",
        "/ns/wait_for",
        "/ns/{goal}",
        "/ns/inner",
    ]
    assert {"/ns/told", "/ns/second", "/ns/plain"} <= set(names(found))
    assert "/ns/lost" not in names(found)
    notes = {note.what: note for note in found.unresolved}
    place = notes["tree node Hidden"].evidence[0]
    line = Path(place.file).read_text().splitlines()[place.line - 1]
    assert ("createTree" if "Text" in loads else "<Hidden/>") in line
    assert not {"tree node Sequence", "tree node Never", "behaviour trees"} & set(notes)


@pytest.mark.parametrize("loads", ["", "factory_.registerBehaviorTreeFromFile(given());"])
def test_trees_that_are_not_known_are_noted(tmp_path, loads):
    found = engine(tmp_path, loads)
    assert names(found) == []
    assert "behaviour trees" in [note.what for note in found.unresolved]


@pytest.mark.parametrize(
    ("xml", "why"),
    [
        ('<!DOCTYPE r [<!ENTITY a "b">]><root><BehaviorTree ID="M">&a;</BehaviorTree></root>',
         "type"),
        ("<root><BehaviorTree>", "not XML"),
        (f'<root><BehaviorTree ID="Main">{"<Wait/>" * (MAX_NODES + 1)}</BehaviorTree></root>',
         "more than"),
    ],
)  # fmt: skip
def test_a_tree_that_is_hostile_is_refused_and_noted(tmp_path, xml, why):
    found = engine(tmp_path, xml=xml)
    assert names(found) == []
    (note,) = [note for note in found.unresolved if note.what.startswith("behaviour tree /")]
    assert why in note.why


def test_a_tree_that_the_build_installs_elsewhere_is_read(tmp_path):
    found = engine(tmp_path, AT_ONCE.replace('/ "main.xml"', '/ "trees" / "main.xml"'))
    assert "/ns/first" in names(found)


def test_a_tree_outside_of_the_packages_is_not_read(tmp_path):
    found = engine(tmp_path, 'tree_ = factory_.createTreeFromFile("/etc/passwd", blackboard_);')
    notes = {note.what: note.why for note in found.unresolved}
    assert "not in the folders" in notes["behaviour tree /etc/passwd"]


def test_what_a_tree_calls_of_its_nodes_is_run(tmp_path):
    calls = """  BT::NodeStatus tick() override {
    config().blackboard->get<rclcpp::Node::SharedPtr>("node")
      ->create_publisher<std_msgs::msg::Bool>("ticked", 1); }
  static BT::PortsList"""
    text = TREE.replace("  static BT::PortsList", calls, 1)
    found = engine(tmp_path, library=text)
    assert "/ns/ticked" in names(found)
    assert not [note for note in found.unresolved if "nothing that is seen calls it" in note.why]
