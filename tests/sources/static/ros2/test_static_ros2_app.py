"""An app of ROS 2 in source, from what its launch file starts to the graph."""

import pytest
from ros2_robot import write_robot

from rtron.errors import InputError
from rtron.sources.launch.common.launch_file import launch_generation
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import ActionRole, Direction, Reliability, Trust

ONE = ScanOptions(workers=1)


def scan(folder, name, **arguments):
    launch = folder / "parts" / "launch" / name
    return scan_ros2_app([folder], [(launch, arguments)], {}, ONE)


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return write_robot(tmp_path_factory.mktemp("robot"))


@pytest.fixture(scope="module")
def graph(robot):
    return scan(robot, "robot.launch.xml")


@pytest.fixture(scope="module")
def more(robot):
    return scan(robot, "more.launch.xml", kind="x")


def ends(graph, node, *, implicit=False):
    """Return the topics of a node, published with `>` and subscribed with `<`."""
    return {
        ("> " if e.direction is Direction.PUBLISH else "< ") + e.topic
        for e in graph.endpoints
        if e.node == node and e.implicit is implicit
    }


def test_each_component_and_node_is_one_of_its_own(graph):
    assert graph.ros == 2
    assert graph.app == "robot"
    assert [node.name for node in graph.nodes] == [
        "/box",
        "/robot/smooth",
        "/robot/inner",
        "/robot/pad",
        "/base/driver",
    ]
    smooth = graph.nodes[1]
    assert (smooth.package, smooth.executable) == ("parts", "parts::Smoother")
    assert smooth.origin.endswith("robot.launch.xml:5")
    assert smooth.trust is Trust.OWN


def test_the_remaps_of_a_container_are_not_those_of_its_components(graph):
    assert ends(graph, "/robot/smooth") == {"> /cmd_vel", "< /robot/cmd_vel_nav", "> /robot/seen"}
    assert ends(graph, "/robot/inner") == {"> /robot/noticed"}


def test_the_first_rule_that_fits_counts(graph):
    assert ends(graph, "/robot/pad") == {"> /robot/cmd_vel_nav"}
    (service,) = [one for one in graph.services if one.type == "std_srvs/srv/Empty"]
    assert (service.name, service.implicit) == ("/robot/pad/halt", False)


def test_a_node_that_no_launch_names_or_places_does_so_itself(graph):
    assert ends(graph, "/base/driver") == {"< /cmd_vel", "> /base/driver/state"}


def test_an_action_is_one_unit(graph):
    (action,) = graph.actions
    assert (action.node, action.name) == ("/robot/pad", "/robot/spin")
    assert (action.type, action.role) == ("nav2_msgs/action/Spin", ActionRole.CLIENT)
    assert not [topic for topic in graph.topics if "_action" in topic.name]


def test_what_every_node_has_is_implicit_and_the_clock_is_the_simulated_ones(graph):
    assert "< /clock" in ends(graph, "/robot/smooth", implicit=True)
    assert "< /clock" not in ends(graph, "/base/driver", implicit=True)
    assert ends(graph, "/box", implicit=True) == {"> /rosout", "< /parameter_events"}
    events = {"> /rosout", "> /parameter_events", "< /parameter_events"}
    assert ends(graph, "/base/driver", implicit=True) == events
    assert "/box/set_parameters" not in {one.name for one in graph.services}
    loading = [one for one in graph.services if one.name == "/box/_container/load_node"]
    assert [one.implicit for one in loading] == [True]


def test_types_qos_and_places_are_those_of_the_source(graph):
    (out,) = [e for e in graph.publishers("/cmd_vel") if e.node == "/robot/smooth"]
    assert out.type == "geometry_msgs/msg/Twist"
    assert (out.qos.depth, out.qos.reliability) == (7, Reliability.RELIABLE)
    assert (out.evidence[0].file.rpartition("/")[2], out.evidence[0].line) == ("smooth.cpp", 7)
    assert graph.unresolved == ()


@pytest.mark.parametrize("name", ["robot.launch.yaml", "robot.launch.py"])
def test_each_format_starts_the_same(robot, graph, name):
    other = scan(robot, name)
    assert [node.name for node in other.nodes] == [node.name for node in graph.nodes]
    assert {(e.node, e.topic, e.direction, e.type) for e in other.endpoints} == {
        (e.node, e.topic, e.direction, e.type) for e in graph.endpoints
    }
    assert set(other.services) == set(graph.services)
    assert other.actions == graph.actions


def test_an_argument_decides_a_name(robot):
    graph = scan(robot, "robot.launch.py", out="/drive")
    assert "> /drive" in ends(graph, "/robot/smooth")


def test_what_is_missing_is_noted_with_its_place_and_what_to_do(more):
    notes = {note.what: note for note in more.unresolved}
    away = notes["node /away (far/away)"]
    assert away.why == "its package is not here: give the folder of its source too"
    assert away.evidence[0].line == 4
    assert notes["node /none (keys/none)"].missing == "keys/none"
    assert "/elsewhere" in notes["component /*"].why
    assert notes["process rviz -d"].evidence[0].line == 9


def test_a_condition_that_is_not_known_is_said_where_the_node_is(more):
    origins = {node.name: node.origin for node in more.nodes}
    assert origins["/keys"].endswith("more.launch.xml:3 (on a condition that is not known)")
    assert not origins["/away"].endswith(")")


def test_an_argument_that_is_needed_is_asked_for(robot):
    with pytest.raises(InputError, match="argument 'kind' is not given") as raised:
        scan(robot, "more.launch.xml")
    assert raised.value.help == "add kind:=VALUE"


def test_a_launch_file_that_cannot_be_read_is_refused(robot, tmp_path):
    broken = tmp_path / "broken.launch.xml"
    broken.write_text("<launch>")
    with pytest.raises(InputError, match="not XML"):
        scan_ros2_app([robot], [(broken, {})], {}, ONE)


@pytest.mark.parametrize(
    ("text", "build", "ros"),
    [
        ('<launch><node pkg="a" exec="b"/></launch>', "catkin", 2),
        ('<launch><node pkg="a" type="b" name="c"/></launch>', "catkin", 1),
        ("<launch/>", "ament_cmake", 2),
        ("<launch/>", "catkin", 1),
        ("<launch", "ament_python", 2),
    ],
)
def test_the_ros_of_xml_is_told_by_its_elements_then_by_its_package(tmp_path, text, build, ros):
    manifest = f"<package><name>a</name><export><build_type>{build}</build_type></export></package>"
    (tmp_path / "package.xml").write_text(manifest)
    (tmp_path / "app.launch.xml").write_text(text)
    assert launch_generation(tmp_path / "app.launch.xml") == ros
    assert launch_generation(tmp_path / "app.launch.py") == 2


HIDING = """import rclpy
from somewhere.robots import Robot
def main():
    rclpy.init()
    robot = Robot("robot")
    robot.drive()
main()
"""


STARTING = "import os\nos.system('ros2 launch web web.launch.py')\n"


@pytest.mark.parametrize(("program", "started"), [(HIDING, []), (STARTING + HIDING, ["web"])])
def test_a_program_that_makes_no_node_that_is_seen_is_noted(tmp_path, program, started):
    (tmp_path / "package.xml").write_text("<package format='3'><name>app</name></package>")
    cmake = "project(app)\ninstall(PROGRAMS drive.py DESTINATION lib/${PROJECT_NAME})\n"
    (tmp_path / "CMakeLists.txt").write_text(cmake)
    (tmp_path / "drive.py").write_text(program)
    launch = tmp_path / "app.launch.xml"
    launch.write_text("<launch><node pkg='app' exec='drive.py'/></launch>")
    graph = scan_ros2_app([tmp_path], [(launch, {})], {}, ONE)
    assert [node.name for node in graph.nodes] == ["/drive"]
    (note, *launches) = graph.unresolved
    assert [launch.package for launch in launches] == started
    assert note.what == "node /drive (app/drive.py)"
    assert "no node is seen that it makes" in note.why


def test_what_is_not_understood_in_build_files_of_its_packages_is_noted(tmp_path):
    cmake = "option(ARM)\nif(ARM)\nadd_executable(arm a.cpp)\nendif()\nmy_node(x a.cpp)\n"
    for name, text in {"p": cmake, "other": "my_node(x a.cpp)"}.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
        (tmp_path / name / "CMakeLists.txt").write_text(text)
        (tmp_path / name / "a.cpp").write_text("int main() {}")
    launch = tmp_path / "a.launch.xml"
    launch.write_text('<launch><node pkg="p" exec="arm"/></launch>')
    notes = scan_ros2_app([tmp_path], [(launch, {})], {}, ONE).unresolved
    found = {note.what: (note.evidence[0].file, note.evidence[0].line) for note in notes}
    assert found["my_node(x …)"] == (f"{tmp_path}/p/CMakeLists.txt", 5)
    assert found["program p/arm"] == (f"{tmp_path}/p/CMakeLists.txt", 2)


def test_an_argument_that_one_of_several_launch_files_declares_is_declared(tmp_path):
    paths = [tmp_path / name for name in ("a.launch.xml", "b.launch.xml")]
    paths[0].write_text("<launch/>")
    paths[1].write_text('<launch><arg name="joystick" default="0"/></launch>')

    def notes(name):
        wanted = [(path, {name: "1"}) for path in paths]
        return [note.what for note in scan_ros2_app([tmp_path], wanted, {}, ONE).unresolved]

    assert notes("joystick") == []
    assert notes("joystik") == ["launch argument joystik"]
