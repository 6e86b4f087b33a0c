"""Hardware components of ros2_control: the nodes that they make in their manager's process."""

import pytest
from file_tree import write

from rtron.sources.launch.ros2.substitutions.substitution import MAX_COMMAND_OUTPUT
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

MANIFEST = """<package format="3"><name>own</name><export><build_type>ament_cmake</build_type>
  <hardware_interface plugin="${prefix}/plugins.xml"/></export></package>"""
PLUGINS = """<library path="arm"><class name="own/Arm" type="own::Arm"
  base_class_type="hardware_interface::SystemInterface"/></library>"""
ARM = """#include <hardware_interface/system_interface.hpp>
namespace own {
class Arm : public hardware_interface::SystemInterface { public:
  CallbackReturn on_init(const hardware_interface::HardwareInfo & info) override {
    if (hardware_interface::SystemInterface::on_init(info) != CallbackReturn::SUCCESS) {
      return CallbackReturn::ERROR; }
    node_ = std::make_shared<rclcpp::Node>("arm_driver");
    topic_ = info.hardware_parameters.at("topic");
    return CallbackReturn::SUCCESS; }
  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
    sent_ = node_->create_publisher<std_msgs::msg::Bool>(topic_, 1);
    more_ = node_->create_publisher<std_msgs::msg::Bool>(info_.hardware_parameters["more"], 1);
    return CallbackReturn::SUCCESS; }
  hardware_interface::return_type read(const rclcpp::Time &, const rclcpp::Duration &) override {
    get_node()->create_publisher<std_msgs::msg::Bool>("~/read", 1);
    return hardware_interface::return_type::OK; }
  std::string topic_;
  rclcpp::Node::SharedPtr node_;
};
}
"""
URDF = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual>{more}</link>
  <ros2_control name="My Arm" type="system"><hardware><plugin>{plugin}</plugin>
    <param name="topic">{told}</param><param name="more">/more</param></hardware></ros2_control>
</robot>"""
PUBLISHED = """<node pkg="robot_state_publisher" exec="robot_state_publisher">
  <param name="robot_description" value="$(command 'xacro $(find-pkg-share own)/arm.urdf')"/>
</node><node pkg="controller_manager" exec="ros2_control_node">{remap}</node>"""
OWN = """<node pkg="controller_manager" exec="ros2_control_node">
  <param name="robot_description" value="$(command 'cat $(find-pkg-share own)/arm.urdf')"/></node>
"""
REMAP = '<remap from="~/robot_description" to="/robot_description"/>'


@pytest.fixture
def launched(tmp_path):
    """Return the graph of a launch with a controller manager and a robot description."""
    files = {"package.xml": MANIFEST, "plugins.xml": PLUGINS, "arm.cpp": ARM}
    files["CMakeLists.txt"] = "add_library(arm arm.cpp)\n"
    write(tmp_path, files)

    def scan(nodes, plugin="own/Arm", more="", told="told", cache=None):
        (tmp_path / "arm.urdf").write_text(URDF.format(plugin=plugin, more=more, told=told))
        launch = tmp_path / "app.launch.xml"
        launch.write_text(f"<launch>{nodes}</launch>")
        return scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1, cache=cache))

    return scan


def sent(graph):
    return {(e.node, e.topic) for e in graph.endpoints if e.evidence[-1].file.endswith("arm.cpp")
            and not e.implicit}  # fmt: skip


JOINED = {("/arm_driver", "/told"), ("/arm_driver", "/more"), ("/my_arm", "/my_arm/read")}


@pytest.mark.parametrize(
    "nodes",
    [OWN, PUBLISHED.format(remap=""), PUBLISHED.format(remap=REMAP)],
    ids=["own", "pub", "re"],
)
def test_a_component_has_the_nodes_that_it_makes(launched, nodes):
    graph = launched(nodes)
    assert sent(graph) == JOINED
    assert {"/controller_manager", "/arm_driver", "/my_arm"} <= {n.name for n in graph.nodes}
    assert not [note for note in graph.unresolved if "hardware" in note.what]


SHAPE = "<visual><geometry><mesh filename='file:///arm.dae'/></geometry></visual>"
MACROS = f"""<xacro:macro name="some" params="">{SHAPE * 160}</xacro:macro>
<xacro:macro name="many" params="">{"<xacro:some/>" * 100}</xacro:macro><xacro:many/>"""


@pytest.mark.parametrize(
    ("nodes", "shapes"), [(OWN, SHAPE * 16_000), (PUBLISHED.format(remap=""), MACROS)]
)
def test_a_large_description_is_read_without_its_shapes(launched, nodes, shapes):
    assert len(SHAPE) * 16_000 > MAX_COMMAND_OUTPUT
    graph = launched(nodes, more=shapes)
    assert sent(graph) == JOINED
    (note,) = [note for note in graph.unresolved if "without its shapes" in note.why]
    assert note.evidence[0].file.endswith("arm.urdf")


@pytest.mark.parametrize(
    ("plugin", "noted"),
    [("other/Arm", ["hardware My Arm (other/Arm)"]), ("mock_components/GenericSystem", [])],
)
def test_a_component_that_is_not_here_is_noted_unless_it_joins_nothing(launched, plugin, noted):
    graph = launched(OWN, plugin)
    assert [note.what for note in graph.unresolved] == noted


def test_a_component_with_a_model_has_a_node_beside_its_manager(launched):
    plugin = "dynamixel_hardware_interface/DynamixelHardware"
    renamed = f'{plugin}</plugin><param name="reboot_dxl_srv_name">/again</param><plugin>x'
    for manager, namespace in (
        (OWN, ""),
        (OWN.replace("exec=", 'namespace="left" exec='), "/left"),
    ):
        graph = launched(manager, renamed)
        assert graph.unresolved == ()
        node = f"{namespace}/dynamixel_hardware_interface"
        services = {each.name for each in graph.services if each.node == node and not each.implicit}
        own = {f"{node}/{name}" for name in ("get_dxl_data", "set_dxl_data", "set_dxl_torque")}
        assert services == {"/again", *own}
        processes = {each.name: each.process for each in graph.nodes}
        assert processes[node] == processes[f"{namespace}/controller_manager"] != ""


def test_a_description_that_is_not_known_is_noted(launched):
    nodes = OWN.replace("arm.urdf", "none.urdf")
    graph = launched(nodes)
    assert "hardware of /controller_manager" in [note.what for note in graph.unresolved]
    assert [node.name for node in graph.nodes] == ["/controller_manager"]


def test_a_kept_result_is_of_its_own_description(launched, tmp_path_factory):
    cache = tmp_path_factory.mktemp("kept")
    cache.chmod(0o700)
    topics = [
        {topic for _, topic in sent(launched(PUBLISHED.format(remap=""), told=told, cache=cache))}
        for told in ("first", "second")
    ]
    assert topics == [{f"/{told}", "/more", "/my_arm/read"} for told in ("first", "second")]


def test_a_component_without_a_node_of_its_own_is_none(launched, tmp_path):
    silent = ARM[: ARM.index("  CallbackReturn on_init")] + "};\n}\n"
    (tmp_path / "arm.cpp").write_text(silent)
    graph = launched(OWN)
    assert [node.name for node in graph.nodes] == ["/controller_manager"]
    assert graph.unresolved == ()
