"""Controllers of ros2_control whose source is in the workspace."""

import pytest
from file_tree import write

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

MANIFEST = """<package format="3"><name>own</name><export><build_type>ament_cmake</build_type>
  <controller_interface plugin="${prefix}/plugins.xml"/></export></package>"""
CMAKE = """cmake_minimum_required(VERSION 3.8)
project(own)
add_library(own SHARED src/light.cpp src/other.cpp)
pluginlib_export_plugin_description_file(controller_interface plugins.xml)
ament_package()
"""
PLUGINS = """<library path="own">
  <class name="own/Light" type="own::Light"
         base_class_type="controller_interface::ControllerInterface"/>
  <class name="own/Other" type="own::Other"
         base_class_type="controller_interface::ChainableControllerInterface"/>
</library>"""
HEADER = """#include <controller_interface/controller_interface.hpp>
namespace own {
class Light : public controller_interface::ControllerInterface {
public:
  CallbackReturn on_init() override;
  CallbackReturn on_configure(const rclcpp_lifecycle::State & before) override;
  std::shared_ptr<ParamListener> listener_;
};
}
"""
LIGHT = """#include "light.hpp"
namespace own {
CallbackReturn own::Light::on_init() {
  listener_ = std::make_shared<ParamListener>(get_node());
  return CallbackReturn::SUCCESS;
}
CallbackReturn own::Light::on_configure(const rclcpp_lifecycle::State &) {
  if (!listener_) { return CallbackReturn::ERROR; }
  auto name = auto_declare<std::string>("topic", "~/light");
  get_node()->create_publisher<std_msgs::msg::Bool>(name, 1);
  get_node()->create_subscription<std_msgs::msg::Bool>("switch", 1, [](auto) {});
  return CallbackReturn::SUCCESS;
}
}
"""
OTHER = """#include <controller_interface/chainable_controller_interface.hpp>
namespace own {
class Other : public controller_interface::ChainableControllerInterface {
  CallbackReturn on_init() override {
    get_node()->create_publisher<std_msgs::msg::Bool>("~/other", 1);
    return CallbackReturn::SUCCESS;
  }
};
}
"""
LAUNCH = """<launch>
  <node pkg="controller_manager" exec="ros2_control_node">
    <param from="$(find-pkg-share own)/control.yaml"/></node>
  <node pkg="controller_manager" exec="spawner" args="lamp {more}"/>
  {command}
</launch>"""
YAML = """controller_manager:
  ros__parameters:
    lamp: {type: own/Light}
    second: {type: own/Other}
    missing: {type: own/None}
lamp:
  ros__parameters: {topic: "~/glow"}
"""


@pytest.fixture
def launched(tmp_path):
    """Return the graph of a launch that spawns a lamp and more controllers."""
    top = tmp_path / "own"
    (top / "src").mkdir(parents=True)
    files = {"package.xml": MANIFEST, "CMakeLists.txt": CMAKE, "plugins.xml": PLUGINS}
    files |= {"src/light.hpp": HEADER, "src/light.cpp": LIGHT, "src/other.cpp": OTHER}
    files |= {"control.yaml": YAML}
    write(top, files)

    def scan(more="", command=""):
        written = f'<executable cmd="{command}"/>' if command else ""
        (top / "app.launch.xml").write_text(LAUNCH.format(more=more, command=written))
        launches = [(top / "app.launch.xml", {})]
        return scan_ros2_app([top], launches, {}, ScanOptions(workers=1))

    return scan


def ends(graph, node):
    return {
        (e.direction.value, e.topic) for e in graph.endpoints if e.node == node and not e.implicit
    }


def test_a_controller_is_read_from_its_source(launched):
    graph = launched("second")
    assert ends(graph, "/lamp") == {("publish", "/lamp/glow"), ("subscribe", "/switch")}
    assert ends(graph, "/second") == {("publish", "/second/other")}
    assert graph.unresolved == ()
    (sent,) = graph.publishers("/lamp/glow")
    assert sent.evidence[-1].file.endswith("light.cpp")
    services = {s.name for s in graph.services}
    assert "/lamp/get_parameters" in services
    assert "/lamp/change_state" not in services
    assert {node.package for node in graph.nodes if node.name == "/lamp"} == {"own"}


def test_a_controller_of_which_there_is_no_source_is_noted(launched):
    graph = launched("missing")
    assert [note.why for note in graph.unresolved] == ["no model of own/None"]
    assert [node.name for node in graph.nodes if node.unread] == ["/missing"]


@pytest.mark.parametrize("options", ["", "-c /controller_manager --set-state active"])
def test_a_command_loads_a_controller(launched, options):
    graph = launched(command=f"ros2 control load_controller {options} second")
    assert ends(graph, "/second") == {("publish", "/second/other")}
    assert {client.name for client in graph.clients if client.node == "/_ros2cli_*"} >= {
        "/controller_manager/load_controller"
    }
    assert graph.unresolved == ()
    (note,) = launched(command="ros2 control list_controllers").unresolved
    assert note.what == "process ros2 control"


def untyped(graph):
    facts = (fact for fact in graph.wiring if fact.kind == "untyped_controller")
    return [(fact.subject, fact.value, *fact.others) for fact in facts]


def test_a_controller_that_the_manager_has_no_type_of(launched):
    graph = launched("secnd")
    assert untyped(graph) == [("/secnd", "/spawner_lamp", "missing", "second")]
    assert untyped(launched("second")) == []
    assert untyped(launched("secnd --controller-type own/Other")) == []


def test_a_file_of_the_spawner_may_tell_the_type(launched, tmp_path):
    (tmp_path / "own" / "more.yaml").write_text("secnd: {ros__parameters: {type: own/Other}}")
    assert untyped(launched("secnd -p $(find-pkg-share own)/more.yaml")) == []
    assert untyped(launched("secnd -p /none.yaml")) == []


def test_where_the_manager_is_not_known_nothing_is(launched):
    assert untyped(launched("secnd -c /other_manager")) == []


def test_the_section_of_a_controller_that_nothing_loads_is_for_it(launched, tmp_path):
    yaml = tmp_path / "own" / "control.yaml"
    yaml.write_text(YAML + "spawner_lam:\n  ros__parameters: {a: 1}\n")
    kind = "section_without_node"
    assert [f.subject for f in launched().wiring if f.kind == kind] == ["/spawner_lam"]
    yaml.write_text(yaml.read_text().replace("second:", "spawner_lam:"))
    assert not [fact for fact in launched().wiring if fact.kind == kind]


@pytest.mark.parametrize(("manager", "time"), [("", False), ("--controller-manager /sim", None)])
def test_who_does_not_know_the_manager_does_not_know_the_time(launched, manager, time):
    graph = launched(f"--controller-type diff_drive_controller/DiffDriveController {manager}")
    name = "/sim/lamp" if manager else "/lamp"
    times = {p.node: p.value for p in graph.parameters if p.name == "use_sim_time"}
    assert times.get(name) is time
