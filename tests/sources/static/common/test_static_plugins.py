"""Plugins of the workspace in nodes of models: costmap layers, planners, controllers."""

import pytest
from file_tree import write

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import scan_app
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import Resolution

MANIFEST = """<package format="2"><name>own</name><export>{export}</export></package>"""
CLASS = """<library path="lib/lib{0}">
  <class name="own/{1}" type="own::{1}" base_class_type="{2}"/></library>"""
ROS1_BASES = {"layer": "costmap_2d::Layer", "planner": "nav_core::BaseGlobalPlanner"}
ROS2_BASES = {
    "layer": "nav2_costmap_2d::Layer",
    "planner": "nav2_core::GlobalPlanner",
    "controller": "nav2_core::Controller",
}
ROS1 = {
    "layer": """#include <costmap_2d/layer.h>
namespace own {
class Layer : public costmap_2d::Layer { public:
  Layer() : nh_("~") { nh_.advertise<std_msgs::Bool>("made", 1); }
  void onInitialize() override {
    ros::NodeHandle own("~/" + name_);
    std::string topic;
    own.param<std::string>("topic", topic, "usual");
    sub_ = own.subscribe(topic, 1, &Layer::hear, this); }
  void updateCosts(costmap_2d::Costmap2D& grid, int a, int b, int c, int d) override {
    ros::NodeHandle().advertise<std_msgs::Bool>("updated", 1); }
  void hear(const std_msgs::Bool& m) {}
  ros::NodeHandle nh_;
  ros::Subscriber sub_; };
}""",
    "planner": """#include <nav_core/base_global_planner.h>
namespace own {
class Planner : public nav_core::BaseGlobalPlanner { public:
  void initialize(std::string name, costmap_2d::Costmap2DROS* costmap) override {
    ros::NodeHandle own("~/" + name);
    pub_ = own.advertise<nav_msgs::Path>("plan", 1); }
  ros::Publisher pub_; };
}""",
}
ROS2 = {
    "layer": """#include <nav2_costmap_2d/layer.hpp>
namespace own {
class Layer : public nav2_costmap_2d::Layer { public:
  void onInitialize() override {
    auto node = node_.lock();
    declareParameter("topic", rclcpp::ParameterValue("usual"));
    std::string topic;
    node->get_parameter(name_ + ".topic", topic);
    sub_ = node->create_subscription<std_msgs::msg::Bool>(topic, 1, [](auto m) {}); }
  rclcpp::SubscriptionBase::SharedPtr sub_; };
}""",
    "planner": """#include <nav2_core/global_planner.hpp>
namespace own {
class Planner : public nav2_core::GlobalPlanner { public:
  void configure(const rclcpp_lifecycle::LifecycleNode::WeakPtr & parent, std::string name,
    std::shared_ptr<tf2_ros::Buffer>, std::shared_ptr<nav2_costmap_2d::Costmap2DROS>) override {
    auto node = parent.lock();
    pub_ = node->create_publisher<nav_msgs::msg::Path>(name + "/path", 1); }
  rclcpp::PublisherBase::SharedPtr pub_; };
}""",
    "controller": """#include <nav2_core/controller.hpp>
namespace own {
class Controller : public nav2_core::Controller { public:
  void configure(const rclcpp_lifecycle::LifecycleNode::WeakPtr & parent, std::string name,
    std::shared_ptr<tf2_ros::Buffer>, std::shared_ptr<nav2_costmap_2d::Costmap2DROS>) override {
    node_ = parent.lock();
    auto topic = rclcpp::ParameterValue("unused");
    nav2_util::declare_parameter_if_not_declared(node_, name + ".topic", topic);
    node_->get_parameter(name + ".topic", topic_); }
  void activate() override { node_->create_publisher<nav_msgs::msg::Path>(topic_, 1); }
  std::string topic_;
  rclcpp_lifecycle::LifecycleNode::SharedPtr node_; };
}""",
}


def write_package(folder, sources, bases):
    export = "".join(
        f'<{base.partition("::")[0]} plugin="${{prefix}}/{kind}.xml"/>'
        for kind, base in bases.items()
    )
    files = {"package.xml": MANIFEST.format(export=export), "CMakeLists.txt": "project(own)\n"}
    for kind, text in sources.items():
        files[f"{kind}.cpp"] = text
        files[f"{kind}.xml"] = CLASS.format(kind, kind.capitalize(), bases[kind])
        files["CMakeLists.txt"] += f"add_library({kind} {kind}.cpp)\n"
    write(folder, files)


def own_names(graph):
    """Return what the sources of the plugins declare: node and topic."""
    ours = (e for e in graph.endpoints if e.resolution is not Resolution.MODEL and not e.implicit)
    return {(end.node, end.topic) for end in ours}


MOVE_BASE = """<launch>
  <node pkg="move_base" type="move_base" name="move_base">
    <param name="base_global_planner" value="{planner}"/>
    <rosparam>
global_costmap:
  plugins:
  - {{name: mine, type: "{layer}"}}
  mine: {{topic: told}}
    </rosparam>
  </node>
</launch>"""


@pytest.fixture
def move_base(tmp_path):
    """Return the graph of a launch with move_base, its planner and a layer of its costmap."""

    def scan(**names):
        write_package(tmp_path, ROS1, ROS1_BASES)
        (tmp_path / "app.launch").write_text(MOVE_BASE.format(**names))
        options = ScanOptions(workers=1, cache=None)
        return scan_app([tmp_path], [(tmp_path / "app.launch", {})], {}, options).graph

    return scan


@pytest.mark.parametrize("form", ["own/{}", "own::{}"])
def test_the_plugins_of_move_base_are_run_below_their_names(move_base, form):
    graph = move_base(layer=form.format("Layer"), planner=form.format("Planner"))
    assert own_names(graph) == {
        ("/move_base", "/move_base/made"),
        ("/move_base", "/move_base/global_costmap/mine/told"),
        ("/move_base", "/updated"),
        ("/move_base", "/move_base/Planner/plan"),
    }
    assert not [note for note in graph.unresolved if "no model" in note.why]


def test_a_plugin_that_is_not_here_keeps_its_note(move_base):
    graph = move_base(layer="own/Layer", planner="other/Planner")
    assert ("/move_base", "/move_base/made") in own_names(graph)
    notes = {note.what: note.why for note in graph.unresolved if "no model" in note.why}
    assert list(notes) == ["plugin:other/Planner"]


NAV2 = """controller_server: {ros__parameters: {
  controller_plugins: [Follow], Follow: {plugin: own::Controller, topic: steered}}}
planner_server: {ros__parameters: {planner_plugins: [Grid], Grid: {plugin: own/Planner}}}
global_costmap: {global_costmap: {ros__parameters: {
  plugins: [mine], mine: {plugin: "own/Layer", topic: told}}}}
"""
PROCESSES = """<launch><push_ros_namespace namespace="r"/>
  <node pkg="nav2_controller" exec="controller_server"><param from="{0}"/></node>
  <node pkg="nav2_planner" exec="planner_server"><param from="{0}"/></node></launch>"""
COMPONENTS = """<launch><push_ros_namespace namespace="r"/>
  <node_container pkg="rclcpp_components" exec="component_container" name="box" namespace="">
    <param from="{0}"/>
    <composable_node pkg="nav2_controller" plugin="nav2_controller::ControllerServer"
      name="controller_server" namespace=""><param from="{0}"/></composable_node>
    <composable_node pkg="nav2_planner" plugin="nav2_planner::PlannerServer"
      name="planner_server" namespace=""><param from="{0}"/></composable_node>
  </node_container></launch>"""


def scan_nav2(folder, launch, parameters=NAV2):
    write_package(folder, ROS2, ROS2_BASES)
    (folder / "nav2.yaml").write_text("r:\n  " + parameters.replace("\n", "\n  ").rstrip())
    (folder / "app.launch.xml").write_text(launch.format(folder / "nav2.yaml"))
    launches = [(folder / "app.launch.xml", {})]
    options = ScanOptions(workers=1, cache=None)
    return scan_ros2_app([folder], launches, {"ROS_DISTRO": "jazzy"}, options)


@pytest.mark.parametrize("launch", [PROCESSES, COMPONENTS])
def test_a_plugin_s_parameter_of_another_type_than_declared(tmp_path, launch):
    graph = scan_nav2(tmp_path, launch, NAV2.replace("steered", "5"))
    found = [fact for fact in graph.wiring if fact.kind == "mistyped_parameter"]
    assert [(fact.subject, fact.value) for fact in found] == [
        ("/r/controller_server", "Follow.topic")
    ]


@pytest.mark.parametrize("launch", [PROCESSES, COMPONENTS])
def test_the_plugins_of_nav2_are_run_with_their_nodes(tmp_path, launch):
    graph = scan_nav2(tmp_path, launch)
    assert own_names(graph) == {
        ("/r/controller_server", "/r/steered"),
        ("/r/planner_server", "/r/Grid/path"),
        ("/r/global_costmap/global_costmap", "/r/global_costmap/told"),
    }
    assert not [note for note in graph.unresolved if "own" in note.what]
