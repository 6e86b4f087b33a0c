"""Well-known nodes of ROS 2 in launch files, without their source."""

import pytest
from file_tree import write

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import Direction

HUMBLE = {"ROS_DISTRO": "humble"}


@pytest.fixture
def launched(tmp_path):
    """Return the graph of an app of files; the launch file is the first."""
    top = tmp_path / "robot"
    top.mkdir()
    (top / "package.xml").write_text("<package><name>robot</name></package>")

    def scan(files, environ=None):
        write(top, files)
        launch = top / next(iter(files))
        return scan_ros2_app([top], [(launch, {})], environ or {}, ScanOptions(workers=1))

    return scan


def ends(graph, node):
    shown = [
        ("> " if e.direction is Direction.PUBLISH else "< ") + f"{e.topic} {e.type}"
        for e in graph.endpoints
        if e.node == node and not e.implicit
    ]
    shown += [f"s {s.name} {s.type}" for s in graph.services if s.node == node and not s.implicit]
    return {*shown, *(f"{a.role.value} {a.name} {a.type}" for a in graph.actions if a.node == node)}


BRIDGE = """<launch>
  <include file="$(find-pkg-share rosbridge_server)/launch/rosbridge_websocket_launch.xml">
    <arg name="port" value="9091"/>
  </include>
</launch>"""


def test_a_launch_file_that_rosbridge_brings(launched):
    graph = launched({"app.launch.xml": BRIDGE})
    assert {"/rosbridge_websocket", "/rosapi"} <= {node.name for node in graph.nodes}
    (port,) = [each.value for each in graph.parameters if each.name == "port"]
    assert port == 9091
    assert not [note for note in graph.unresolved if note.what.startswith("include")]


MUX = """<launch>
  <push-ros-namespace namespace="r1"/>
  <node pkg="twist_mux" exec="twist_mux">
    <param from="$(find-pkg-share robot)/mux.yaml"/>
    <remap from="cmd_vel_out" to="/r1/base/cmd_vel"/>
    <remap from="joy_vel" to="stick"/>
  </node>
</launch>"""
MUX_YAML = """/**:
  ros__parameters:
    topics:
      joy: {topic: joy_vel, timeout: 0.5, priority: 100}
/other:
  ros__parameters:
    topics.no.topic: never
/r1/twist_mux:
  ros__parameters:
    locks:
      stop: {topic: /e_stop, timeout: 0.0, priority: 255}
    use_stamped: false
"""


def test_a_node_without_source_is_known_with_its_parameters_namespace_and_remaps(launched):
    graph = launched({"app.launch.xml": MUX, "mux.yaml": MUX_YAML})
    assert [node.name for node in graph.nodes] == ["/r1/twist_mux"]
    assert ends(graph, "/r1/twist_mux") == {
        "< /r1/stick geometry_msgs/msg/Twist",
        "< /e_stop std_msgs/msg/Bool",
        "> /r1/base/cmd_vel geometry_msgs/msg/Twist",
    }
    assert graph.unresolved == ()
    implied = {e.topic for e in graph.endpoints if e.implicit}
    assert implied == {"/diagnostics", "/rosout", "/parameter_events"}
    assert "/r1/twist_mux/set_parameters" in {s.name for s in graph.services}


PYTHON = """from launch import LaunchDescription
from launch_ros.actions import ComposableNodeContainer, Node
from launch_ros.descriptions import ComposableNode


def generate_launch_description():
    smoother = ComposableNode(
        package="nav2_velocity_smoother",
        plugin="nav2_velocity_smoother::VelocitySmoother",
        name="smoother",
        parameters=[{"enable_stamped_cmd_vel": False, "use_sim_time": True}],
        remappings=[("cmd_vel", "cmd_vel_nav"), ("cmd_vel_smoothed", "/out")],
    )
    unnamed = ComposableNode(package="joy", plugin="joy::Joy")
    return LaunchDescription([
        ComposableNodeContainer(
            package="rclcpp_components",
            executable="component_container",
            name="box",
            namespace="r2",
            composable_node_descriptions=[smoother, unnamed],
        ),
        Node(package="teleop_twist_keyboard", executable="teleop_twist_keyboard",
             parameters=[{"stamped": True}], remappings=[("cmd_vel", "keys")]),
    ])
"""


def test_components_and_a_python_node_are_known(launched):
    graph = launched({"app.launch.py": PYTHON})
    assert {node.name for node in graph.nodes} == {
        "/r2/box",
        "/smoother",
        "/joy_node",
        "/teleop_twist_keyboard",
    }
    assert ends(graph, "/smoother") == {
        "< /odom nav_msgs/msg/Odometry",
        "< /cmd_vel_nav geometry_msgs/msg/Twist",
        "> /out geometry_msgs/msg/Twist",
    }
    assert [e.node for e in graph.subscribers("/clock")] == ["/smoother"]
    assert ends(graph, "/teleop_twist_keyboard") == {"> /keys geometry_msgs/msg/TwistStamped"}
    heard = {e.node for e in graph.subscribers("/parameter_events")}
    assert heard == {"/r2/box", "/smoother", "/joy_node"}


TWO = """<launch>
  <node pkg="turtlebot3_node" exec="turtlebot3_ros" namespace="tb3">
    <param name="odometry.use_imu" value="true"/>
    <param name="enable_stamped_cmd_vel" value="true"/>
  </node>
</launch>"""


def test_a_process_with_two_nodes(launched):
    graph = launched({"app.launch.xml": TWO})
    assert {node.name for node in graph.nodes} == {
        "/tb3/turtlebot3_node",
        "/tb3/diff_drive_controller",
    }
    assert "< /tb3/cmd_vel geometry_msgs/msg/TwistStamped" in ends(graph, "/tb3/turtlebot3_node")
    assert "< /tb3/imu sensor_msgs/msg/Imu" in ends(graph, "/tb3/diff_drive_controller")


CONTROL = """<launch>
  <node pkg="controller_manager" exec="ros2_control_node">
    <param from="$(find-pkg-share robot)/control.yaml"/>
    <remap from="/base/cmd_vel_unstamped" to="/cmd_vel"/>
  </node>
  <node pkg="controller_manager" exec="spawner" args="base joints --controller-manager {manager}"/>
  <node pkg="controller_manager" exec="spawner"
        args="imu -c /controller_manager -p $(find-pkg-share robot)/imu.yaml
              --controller-ros-args '-r imu/imu:=/imu/data'"/>
</launch>"""
CONTROL_YAML = """controller_manager:
  ros__parameters:
    joints: {type: joint_state_broadcaster/JointStateBroadcaster}
    base: {type: diff_drive_controller/DiffDriveController}
    never: {type: diff_drive_controller/DiffDriveController}
base:
  ros__parameters:
    use_stamped_vel: false
"""
IMU_YAML = """/controller_manager:
  ros__parameters:
    imu.type: imu_sensor_broadcaster/IMUSensorBroadcaster
"""
FILES = {"control.yaml": CONTROL_YAML, "imu.yaml": IMU_YAML}


def test_controllers_are_those_that_are_spawned(launched):
    launch = CONTROL.format(manager="/controller_manager")
    graph = launched({"app.launch.xml": launch, **FILES}, HUMBLE)
    assert {"/base", "/joints", "/imu"} <= {node.name for node in graph.nodes}
    assert "/never" not in {node.name for node in graph.nodes}
    assert ends(graph, "/base") == {
        "< /cmd_vel geometry_msgs/msg/Twist",
        "> /base/odom nav_msgs/msg/Odometry",
    }
    assert ends(graph, "/imu") == {"> /imu/data sensor_msgs/msg/Imu"}
    assert "> /joint_states sensor_msgs/msg/JointState" in ends(graph, "/joints")
    assert graph.unresolved == ()


@pytest.mark.parametrize(
    ("manager", "files", "why"),
    [
        ("/elsewhere", FILES, "nothing here starts /elsewhere"),
        ("/controller_manager", {**FILES, "control.yaml": "a: {b: 1}"}, "type is not known"),
        (
            "/controller_manager",
            {**FILES, "control.yaml": CONTROL_YAML.replace("diff_drive_controller/Diff", "x/Y")},
            "no model of x/Y",
        ),
        ("/controller_manager", {**FILES, "imu.yaml": "- {"}, "not YAML"),
    ],
)
def test_a_controller_that_is_not_known_is_noted(launched, manager, files, why):
    graph = launched({"app.launch.xml": CONTROL.format(manager=manager), **files}, HUMBLE)
    assert any(why in note.why for note in graph.unresolved), graph.unresolved


SOURCE = """import rclpy
from rclpy.node import Node
from std_msgs.msg import String
rclpy.init()
node = Node("mux")
node.create_publisher(String, "changed", 1)
rclpy.spin(node)
"""
CMAKE = "install(PROGRAMS twist_mux DESTINATION lib/${PROJECT_NAME})"


@pytest.fixture
def rebuilt(launched, tmp_path):
    """Return the graph of a launch of twist_mux with a source of its own."""
    package = tmp_path / "robot" / "twist_mux"
    package.mkdir()
    (tmp_path / "robot" / "package.xml").unlink()
    (package / "package.xml").write_text("<package><name>twist_mux</name></package>")
    (package / "CMakeLists.txt").write_text(f"project(twist_mux)\n{CMAKE}\n")

    def scan(source):
        (package / "twist_mux").write_text("#!/usr/bin/env python3\n" + source)
        launch = '<launch><node pkg="twist_mux" exec="twist_mux"/></launch>'
        return launched({"app.launch.xml": launch})

    return scan


def test_source_counts_before_a_model(rebuilt):
    assert ends(rebuilt(SOURCE), "/mux") == {"> /changed std_msgs/msg/String"}


UNDECIDED = """if asked():
    node.create_publisher(String, "maybe", 1)
    node.create_publisher(String, "cmd_vel_out", 1)
rclpy.spin(node)
"""


def test_a_model_decides_what_the_source_leaves_open(rebuilt):
    """What the model does not name is not made then, and noted with its place."""
    graph = rebuilt(SOURCE.replace("rclpy.spin(node)\n", UNDECIDED))
    topics = {e.topic for e in graph.endpoints if not e.implicit and e.node == "/mux"}
    assert topics == {"/changed", "/cmd_vel_out"}
    (note,) = [each for each in graph.unresolved if "leaves open" in each.why]
    assert note.what == "publish /maybe"
    assert note.evidence[0].file.endswith("/twist_mux")


def test_a_model_counts_too_where_the_source_gives_no_name(rebuilt):
    graph = rebuilt(SOURCE.replace('"changed"', "asked()"))
    assert {e.topic for e in graph.endpoints if not e.implicit} == {"/cmd_vel_out"}
    (note,) = [each for each in graph.unresolved if "followed in part only" in each.why]
    assert note.what == "node /twist_mux (twist_mux/twist_mux)"


ASKING = """import rclpy
from rclpy.node import Node
from std_srvs.srv import Empty
rclpy.init()
node = Node("asking")
node.declare_parameter("rate", 5)
node.declare_parameter("names", ["a", "b"])
node.declare_parameter("on", False)
if node.get_parameter("on").value:
    node.create_client(Empty, "go")
rclpy.spin(node)
"""


def test_parameters_and_clients_of_source_and_of_models(launched, tmp_path):
    package = tmp_path / "robot"
    (package / "CMakeLists.txt").write_text(
        "project(robot)\ninstall(PROGRAMS asking DESTINATION lib/${PROJECT_NAME})\n"
    )
    (package / "asking").write_text("#!/usr/bin/env python3\n" + ASKING)
    launch = """<launch>
      <node pkg="robot" exec="asking">
        <param name="on" value="true"/><param name="rate" value="7"/><remap from="go" to="/halt"/>
      </node>
      <node pkg="nav2_lifecycle_manager" exec="lifecycle_manager" name="manager">
        <param name="node_names" value="['amcl']"/>
      </node>
    </launch>"""
    graph = launched({"app.launch.xml": launch})
    told = {(p.node, p.name, p.value) for p in graph.parameters}
    assert told == {
        ("/asking", "rate", 7),
        ("/asking", "names", ("a", "b")),
        ("/asking", "on", True),
        ("/asking", "use_sim_time", False),
        ("/manager", "use_sim_time", False),
        ("/manager", "node_names", ("amcl",)),
    }
    assert {(c.node, c.name) for c in graph.clients} == {
        ("/asking", "/halt"),
        ("/manager", "/amcl/change_state"),
        ("/manager", "/amcl/get_state"),
    }


HOSTED = """<launch>
  <node_container pkg="rclcpp_components" exec="component_container" name="box" namespace=""
                  args="--ros-args -p enable_stamped_cmd_vel:=false">
    <composable_node pkg="nav2_velocity_smoother" name="smoother"
                     plugin="nav2_velocity_smoother::VelocitySmoother">{extra}</composable_node>
  </node_container>
</launch>"""
FORWARDED = '<extra_arg name="forward_global_arguments" value="true"/>'


@pytest.mark.parametrize(("extra", "type"), [("", "TwistStamped"), (FORWARDED, "Twist")])
def test_what_a_container_is_given_counts_for_a_component_if_it_is_forwarded(launched, extra, type):
    graph = launched({"app.launch.xml": HOSTED.format(extra=extra)})
    assert f"> /cmd_vel_smoothed geometry_msgs/msg/{type}" in ends(graph, "/smoother")


def test_the_bond_of_nav2_is_a_topic_of_each_namespace(launched):
    group = """<group><push_ros_namespace namespace="{0}"/>
      <node pkg="nav2_lifecycle_manager" exec="lifecycle_manager" name="manager"/>
      <node pkg="nav2_controller" exec="controller_server" name="controller"/></group>"""
    graph = launched({"app.launch.xml": f"<launch>{group.format('a')}{group.format('b')}</launch>"})
    bonds = {topic.name for topic in graph.topics if topic.name.endswith("bond")}
    assert bonds == {"/a/bond", "/b/bond"}
    for robot in "ab":
        nodes = {f"/{robot}/manager", f"/{robot}/controller"}
        assert {end.node for end in graph.publishers(f"/{robot}/bond")} == nodes
        assert {end.node for end in graph.subscribers(f"/{robot}/bond")} == nodes
        assert {end.qos.depth for end in graph.publishers(f"/{robot}/bond")} == {5}
