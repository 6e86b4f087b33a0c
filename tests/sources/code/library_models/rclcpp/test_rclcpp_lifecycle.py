"""Lifecycle nodes, plugins and behaviour trees."""

import pytest
from file_tree import write
from ros2_runs import UNLAUNCHED, implicit_declarations, names, run_text, settings, site

from rtron.sources.code.program_runner import run_cpp
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.static.ros2.app import read_ros2_workspace

LIFECYCLE = """
using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
class L : public rclcpp_lifecycle::LifecycleNode {
public:
  explicit L(const std::string & name) : rclcpp_lifecycle::LifecycleNode(name) {}
  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
    topic_ = "made";
    create_publisher<std_msgs::msg::Bool>("configured", 1);
    return CallbackReturn::SUCCESS; }
  CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
    create_subscription<std_msgs::msg::Bool>(topic_, 1, [](auto m) {});
    return CallbackReturn::SUCCESS; }
  std::string topic_;
};
"""
MAIN = 'int main() { auto one = std::make_shared<L>("one"); rclcpp::spin(one); }'


def test_a_lifecycle_node_is_configured_and_activated():
    found = run_text(LIFECYCLE + MAIN, **UNLAUNCHED)
    assert names(found) == ["/configured", "/made"]
    assert implicit_declarations(found) >= {
        "publish /one/transition_event",
        "service /one/change_state",
        "service /one/get_transition_graph",
    }


def test_each_lifecycle_node_of_a_class_is():
    two = MAIN.replace("rclcpp::spin", 'auto two = std::make_shared<L>("far/two"); rclcpp::spin')
    found = names(run_text(LIFECYCLE + two, **UNLAUNCHED))
    assert sorted(found) == ["/configured", "/far/configured", "/far/made", "/made"]


def test_a_node_may_configure_another():
    main = MAIN.replace("rclcpp::spin", "one->configure(); rclcpp::spin")
    assert names(run_text(LIFECYCLE + main, **UNLAUNCHED)) == ["/configured", "/made"]


@pytest.mark.parametrize("call", ["activate()", "trigger_transition(3)"])
def test_a_node_that_changes_its_own_state_calls_itself(call):
    own = "service_client /one/change_state"
    assert own not in implicit_declarations(run_text(LIFECYCLE + MAIN, **UNLAUNCHED))
    main = MAIN.replace("rclcpp::spin", f"one->{call}; rclcpp::spin")
    assert own in implicit_declarations(run_text(LIFECYCLE + main, **UNLAUNCHED))


CORE = """<package><name>core</name></package>"""
BASE = """#pragma once
namespace core { class Layer { public:
  virtual void start(rclcpp::Node * node, std::string name) = 0; }; }
"""
HOST_CMAKE = "project(host)\nadd_executable(host host.cpp)\n"
HOST = """#include "core/layer.hpp"
#include "layers/helper.hpp"
class Host : public rclcpp::Node { public:
  Host() : Node("host"), loader_("core", "core::Layer") {
    for (auto & name : declare_parameter("layers", std::vector<std::string>{"first"})) {
      auto type = declare_parameter(name + ".plugin", "layers::Static");
      auto layer = loader_.createSharedInstance(type);
      layer->start(this, name);
    }
    layers::Helper helper(this);
  }
  pluginlib::ClassLoader<core::Layer> loader_; };
int main() { rclcpp::spin(std::make_shared<Host>()); }
"""
PLUGINS_CMAKE = """project(layers)
add_library(layers src/static.cpp src/moving.cpp src/helper.cpp)
pluginlib_export_plugin_description_file(core plugins.xml)
"""
PLUGINS = """<library path="layers">
<class type="layers::Static" base_class_type="core::Layer"/>
<class type="layers::Moving" base_class_type="core::Layer"/>
</library>"""
STATIC = """#include "core/layer.hpp"
namespace layers { class Static : public core::Layer { public:
  void start(rclcpp::Node * node, std::string name) override {
    node->create_subscription<nav_msgs::msg::OccupancyGrid>(name + "/map", 1, [](auto m) {}); } }; }
"""
MOVING = """#include "core/layer.hpp"
namespace layers { template<typename T> class MovingT : public core::Layer { public:
  void start(rclcpp::Node * node, std::string name) override {
    node->create_subscription<sensor_msgs::msg::LaserScan>(name + "/scan", 1, [](auto m) {}); } };
  using Moving = MovingT<int>; }
"""
HELPER = """#pragma once
namespace layers { class Helper { public: explicit Helper(rclcpp::Node * node); }; }
"""
HELPER_SOURCE = """#include "layers/helper.hpp"
namespace layers { Helper::Helper(rclcpp::Node * node) {
  node->create_publisher<std_msgs::msg::Bool>("helped", 1); } }
"""


@pytest.fixture
def workspace(tmp_path):
    write(
        tmp_path,
        {
            "core/package.xml": CORE,
            "core/include/core/layer.hpp": BASE,
            "host/package.xml": "<package><name>host</name></package>",
            "host/CMakeLists.txt": HOST_CMAKE,
            "host/host.cpp": HOST,
            "layers/package.xml": "<package><name>layers</name></package>",
            "layers/CMakeLists.txt": PLUGINS_CMAKE,
            "layers/plugins.xml": PLUGINS,
            "layers/include/layers/helper.hpp": HELPER,
            "layers/src/static.cpp": STATIC,
            "layers/src/moving.cpp": MOVING,
            "layers/src/helper.cpp": HELPER_SOURCE,
        },
    )
    return read_ros2_workspace([tmp_path])


def hosted(workspace, **given):
    program = workspace.executable("host", "host")
    return run_cpp(program.sources, site(**given), WorkspaceSources(workspace))


def test_a_plugin_is_what_the_launch_says(workspace):
    given = settings(layers=["a", "b"], b__plugin="layers::Moving")
    found = names(hosted(workspace, settings=given))
    assert found == ["/ns/a/map", "/ns/b/scan", "/ns/helped"]


def test_without_a_launch_every_plugin_of_the_kind_may_be_loaded(workspace):
    found = names(hosted(workspace, **UNLAUNCHED))
    assert found == ["/first/map", "/first/scan", "/{~layers[]}/map", "/helped"]


def test_what_another_package_defines_is_found_in_its_sources(workspace):
    assert "/ns/helped" in names(hosted(workspace))


def test_a_plugin_that_is_nowhere_is_noted(workspace):
    found = hosted(workspace, settings=settings(first__plugin="gone::Layer"))
    why = "/ns/n loads it, and its source is not found: give the folder of its source too"
    assert ("plugin gone::Layer", why) in {(note.what, note.why) for note in found.unresolved}


LOADS = "auto layer = loader_.createSharedInstance(type);"
TRIES = """std::shared_ptr<core::Layer> layer;
      try { layer = others_.createSharedInstance(type); }
      catch (const pluginlib::PluginlibException & e) { %s }"""
OTHERS = 'pluginlib::ClassLoader<core::Other> others_{"core", "core::Other"};'


@pytest.mark.parametrize(("caught", "found"), [(LOADS.removeprefix("auto "), True), ("", False)])
def test_a_plugin_of_another_base_throws(workspace, tmp_path, caught, found):
    host = HOST.replace(LOADS, TRIES % caught).replace("  pluginlib::", f"  {OTHERS} pluginlib::")
    (tmp_path / "host" / "host.cpp").write_text(host)
    interface = hosted(workspace)
    assert ("/ns/first/map" in names(interface)) is found
    assert not [note for note in interface.unresolved if note.what.startswith("plugin")]


def test_a_plugin_that_only_a_running_app_names_is_noted(workspace, tmp_path):
    named = HOST.replace('declare_parameter(name + ".plugin", "layers::Static")', "asked()")
    (tmp_path / "host" / "host.cpp").write_text(named)
    note, passed = hosted(workspace).unresolved
    assert (note.what, note.why) == (
        "plugin {asked()}",
        "/ns/n loads it, and which one it is, is not known",
    )
    assert "its code is not here, and it gets the node /ns/n" in passed.why
