"""What a container's arguments are for (rclcpp_components: ComponentManager; rcl: node)."""

import pytest
from file_tree import write

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import Direction

MANIFEST = (
    "<package><name>cells</name><export><build_type>ament_cmake</build_type></export></package>"
)
CMAKE = """project(cells)
add_library(cell SHARED cell.cpp)
add_executable(box box.cpp)
rclcpp_components_register_node(cell PLUGIN "cells::Cell" EXECUTABLE cell_node)
rclcpp_components_register_nodes(cell "cells::Other")
"""
CELL = """#include <rclcpp/rclcpp.hpp>
namespace cells {
class Cell : public rclcpp::Node {
public:
  explicit Cell(const rclcpp::NodeOptions & options) : Node("cell", "written", options) {
    out_ = create_publisher<std_msgs::msg::Bool>(declare_parameter<std::string>("out", "out"), 1);
    helper_ = std::make_shared<rclcpp::Node>("helper");
    seen_ = helper_->create_publisher<std_msgs::msg::Bool>(
      helper_->declare_parameter<std::string>("out", "helped"), 1);
    copy_ = std::make_shared<rclcpp::Node>("copy", rclcpp::NodeOptions(options).arguments(
      {"--ros-args", "-r", "__node:=copy"}));
    mine_ = copy_->create_publisher<std_msgs::msg::Bool>("out", 1);
  }
};
class Other : public rclcpp::Node {
public:
  explicit Other(const rclcpp::NodeOptions & options) : Node("other", options) {
    out_ = create_publisher<std_msgs::msg::Bool>("other", 1);
  }
};
void hidden(rclcpp::Node & node) { node.create_publisher<std_msgs::msg::Bool>("hidden", 1); }
}
RCLCPP_COMPONENTS_REGISTER_NODE(cells::Cell)
RCLCPP_COMPONENTS_REGISTER_NODE(cells::Other)
"""
BOX = (
    '<node_container pkg="rclcpp_components" exec="component_container" name="box" namespace="far">'
)
OWN_BOX = """#include <rclcpp_components/component_manager.hpp>
int main(int argc, char ** argv) {
  rclcpp::init(argc, argv);
  auto executor = std::make_shared<rclcpp::executors::MultiThreadedExecutor>();
  auto manager = std::make_shared<rclcpp_components::ComponentManager>(executor);
  executor->add_node(manager);
  executor->spin();
}
"""
LAUNCH = """<launch>
  {box}
    <remap from="out" to="moved"/>
    <remap from="helped" to="lent"/>
    {given}
    <composable_node pkg="cells" plugin="cells::Cell" {named}>{own}</composable_node>
  </node_container>
</launch>
"""


@pytest.fixture
def scanned(tmp_path):
    """Return the graph of a launch file around the component."""
    files = {"package.xml": MANIFEST, "CMakeLists.txt": CMAKE, "cell.cpp": CELL, "box.cpp": OWN_BOX}
    write(tmp_path, files)

    def scan(text):
        launch = tmp_path / "app.launch.xml"
        launch.write_text(text)
        return scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))

    return scan


@pytest.fixture
def loaded(scanned):
    def scan(named='name="one" namespace="here"', given="", own=""):
        return scanned(LAUNCH.format(box=BOX, named=named, given=given, own=own))

    return scan


def published(graph):
    return {
        (e.node, e.topic)
        for e in graph.endpoints
        if e.direction is Direction.PUBLISH and not e.implicit
    }


def test_a_component_has_no_argument_of_its_container(loaded):
    graph = loaded(given='<param name="out" value="given"/>')
    assert ("/here/one", "/here/out") in published(graph)


def test_a_node_that_a_component_makes_with_options_of_its_own_is_named_like_the_container(loaded):
    graph = loaded()
    assert ("/far/box", "/far/lent") in published(graph)
    (fact,) = [fact for fact in graph.wiring if fact.kind == "duplicate_node"]
    assert (fact.subject, len(fact.evidence)) == ("/far/box", 2)


def test_what_a_component_beside_it_joins_is_not_missed_other_functions_are(loaded):
    missed = [note.what for note in loaded().unresolved if "nothing that is seen" in note.why]
    assert missed == ["cells::hidden()"]


def test_such_a_node_has_the_parameters_of_the_container(loaded):
    graph = loaded(given='<param name="out" value="given"/>', own='<param name="out" value="own"/>')
    assert ("/far/box", "/far/given") in published(graph)
    assert ("/here/one", "/here/own") in published(graph)


def test_a_node_made_with_a_copy_of_the_options_takes_no_arguments_of_the_container(loaded):
    assert ("/copy", "/out") in published(loaded())


def test_a_component_and_its_nodes_run_in_the_process_of_the_container(loaded):
    processes = {node.name: node.process for node in loaded().nodes}
    assert processes == {"/far/box": "", "/here/one": "/far/box", "/copy": "/far/box"}


def test_a_component_that_is_not_named_names_and_places_itself(loaded):
    assert ("/written/cell", "/written/out") in published(loaded(named=""))


def test_forwarded_arguments_count_behind_the_components_own(loaded):
    forwarded = '<extra_arg name="forward_global_arguments" value="true"/>'
    graph = loaded(named='name="one"', own=forwarded)
    assert ("/far/one", "/far/moved") in published(graph)
    graph = loaded(own=forwarded)
    assert ("/here/one", "/here/moved") in published(graph)


def test_extra_arguments_turn_off_what_every_node_has(loaded):
    extra = "".join(
        f'<extra_arg name="{name}" value="false"/>'
        for name in ("start_parameter_services", "enable_rosout", "start_parameter_event_publisher")
    )
    graph = loaded(own=extra)
    assert [s.name for s in graph.services if s.node == "/here/one"] == [
        "/here/one/get_type_description"
    ]
    implicit = [e for e in graph.endpoints if e.node == "/here/one" and e.implicit]
    assert [(e.topic, e.direction) for e in implicit] == [
        ("/parameter_events", Direction.SUBSCRIBE)
    ]


def test_an_executable_of_a_component_takes_the_arguments_of_its_process(scanned):
    graph = scanned(
        '<launch><node pkg="cells" exec="cell_node" name="alone" namespace="here">'
        '<remap from="out" to="moved"/><param name="out" value="out"/></node></launch>'
    )
    assert ("/here/alone", "/here/moved") in published(graph)


def test_a_container_that_no_launch_starts_leaves_its_components_known(scanned):
    graph = scanned(
        '<launch><load_composable_node target="/away">'
        '<composable_node pkg="cells" plugin="cells::Cell" name="one"/>'
        "</load_composable_node></launch>"
    )
    topics = published(graph)
    assert ("/written/one", "/written/out") in topics
    assert ("/helper", "/helped") in topics
    assert ("/helper", "/{/helper/out}") in topics


@pytest.mark.parametrize(
    ("container", "name"),
    [
        ('pkg="cells" exec="box"', "/ComponentManager"),
        ('pkg="cells" exec="box" name="mine"', "/mine"),
        ('pkg="rclcpp_components" exec="component_container_mt"', "/ComponentManager"),
    ],
)
def test_a_container_is_named_by_the_launch_or_called_like_its_class(scanned, container, name):
    graph = scanned(
        f'<launch><node {container}/><load_composable_node target="{name}">'
        '<composable_node pkg="cells" plugin="cells::Other" name="one"/>'
        "</load_composable_node></launch>"
    )
    assert [node.name for node in graph.nodes] == [name, "/one"]
    own = {one.name.removeprefix(f"{name}/") for one in graph.services if one.node == name}
    loading = {f"_container/{verb}" for verb in ("load_node", "unload_node", "list_nodes")}
    assert own == {"get_type_description", *loading}


@pytest.fixture
def commanded(scanned):
    """Return the graph of a launch that starts a container, and runs a command."""
    launch = f'<launch>{BOX}</node_container><executable cmd="{{}}"/></launch>'
    return lambda line: scanned(launch.format(line))


CALL = "ros2 component load /far/box cells cells::Other"


@pytest.mark.parametrize(
    ("line", "name", "topic"),
    [
        (CALL, "/other", "/other"),
        (f"{CALL} -n late --node-namespace /robot", "/robot/late", "/robot/other"),
        (f"{CALL} -r other:=moved -r __node:=x -q --spin-time 2", "/x", "/moved"),
        ("ros2 component load far/box cells cells::Cell -p out:=told", "/written/cell", None),
    ],
)
def test_a_command_loads_a_component(commanded, line, name, topic):
    graph = commanded(line)
    assert [(node.name, node.package) for node in graph.nodes][1:2] == [(name, "cells")]
    sent = {e.topic for e in graph.endpoints if e.node == name and not e.implicit}
    assert sent == {topic or "/written/told"}
    assert not [note for note in graph.unresolved if "not looked into" in note.why]


def test_a_command_starts_a_container_of_its_own(commanded):
    graph = commanded("ros2 component standalone cells cells::Other -c solo")
    assert {"/solo", "/other"} <= {node.name for node in graph.nodes}
    (loading,) = [s for s in graph.services if s.name == "/solo/_container/load_node"]
    assert loading.node == "/solo"
    unnamed = commanded("ros2 component standalone cells cells::Other")
    assert "/standalone_container_{id}" in {node.name for node in unnamed.nodes}


@pytest.mark.parametrize("line", ["ros2 component load", "ros2 component list", f"{CALL} -n"])
def test_a_command_that_loads_nothing_is_noted(commanded, line):
    graph = commanded(line)
    assert [node.name for node in graph.nodes] == ["/far/box"]
    assert [note.what for note in graph.unresolved] == ["process ros2 component"]


def test_a_command_into_a_container_that_is_not_here_is_noted(commanded):
    graph = commanded(CALL.replace("/far/box", "/none"))
    (note,) = (note for note in graph.unresolved if "its container is /none" in note.why)
    assert note.hides == "nodes"


LISTENER = """    listener_ = std::make_shared<tf2_ros::TransformListener>(*buffer_{});
    helper_ ="""


@pytest.mark.parametrize(
    ("argument", "of_container", "own", "is_noted"),
    [
        ("", "", "moved", True),
        (", this", "", "moved", False),
        ("", "moved", "", False),
        ("", "/moved", "/moved", False),
    ],
)
def test_a_component_s_remap_of_transforms_does_not_reach_a_node_that_it_makes(
    scanned, tmp_path, argument, of_container, own, is_noted
):
    source = CELL.replace("    helper_ =", LISTENER.format(argument), 1)
    (tmp_path / "cell.cpp").write_text(source)
    given, remap = (f'<remap from="/tf" to="{to}"/>' if to else "" for to in (of_container, own))
    launch = LAUNCH.format(box=BOX, given=given, named="", own=remap)
    noted = [fact for fact in scanned(launch).wiring if fact.kind == "unreached_listener"]
    found = [(fact.subject, fact.value, fact.others) for fact in noted]
    assert found == ([("/written/cell", "/written/moved", ("/tf",))] if is_noted else [])
    assert all(place.line for fact in noted for place in fact.evidence)
