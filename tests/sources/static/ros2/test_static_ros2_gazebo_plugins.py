"""Plugins of Gazebo in the robots that a launch of ROS 2 spawns."""

import pytest
from file_tree import write

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import Direction

XACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="topic" default="cmd_vel"/>
  <link name="base"/>
  <gazebo>
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <ros><namespace>own</namespace><remapping>cmd_vel:=$(arg topic)</remapping>
        <remapping>odom:=/odom</remapping></ros>
      <publish_odom>true</publish_odom><publish_odom_tf>1</publish_odom_tf>
    </plugin>
  </gazebo>
  <gazebo reference="base">
    <sensor type="ray" name="lidar">
      <plugin name="laser" filename="libgazebo_ros_ray_sensor.so">
        <ros><remapping>~/out:=scan</remapping></ros>
        <output_type>sensor_msgs/LaserScan</output_type>
        <output_type>sensor_msgs/LaserScan</output_type>
      </plugin>
    </sensor>
    <sensor type="depth" name="eye">
      <plugin name="eye_controller" filename="libgazebo_ros_camera.so"/>
    </sensor>
    <sensor type="multicamera" name="pair">
      <camera name="left"/><camera name="right"/>
      <plugin name="pair_controller" filename="libgazebo_ros_camera.so">
        <camera_name>stereo</camera_name>
      </plugin>
    </sensor>
  </gazebo>
</robot>"""
LAUNCH = """<launch>
  <group>
    <push-ros-namespace namespace="bot"/>
    <node pkg="robot_state_publisher" exec="robot_state_publisher">
      <param name="robot_description"
             value="$(command 'xacro $(find-pkg-share robot)/robot.xacro topic:=moved')"/>
    </node>
    <node pkg="gazebo_ros" exec="spawn_entity.py"
          args="-entity r -topic robot_description {args}"/>
  </group>
</launch>"""
SDF = """<sdf version="1.6"><model name="m"><link name="l"><sensor type="imu" name="imu">
  <plugin name="imu" filename="libgazebo_ros_imu_sensor.so"/></sensor></link>
  <plugin name="states" filename="libgazebo_ros_joint_state_publisher.so">
    <joint_name>a</joint_name><joint_name>b</joint_name></plugin>
  <plugin name="truth" filename="libgazebo_ros_p3d.so"><body_name>l</body_name></plugin>
  <plugin name="plane" filename="libgazebo_ros_planar_move.so"/>
  <plugin name="steer" filename="libgazebo_ros_ackermann_drive.so">
    <publish_distance>true</publish_distance></plugin>
  <plugin name="odd" filename="libodd.so"/>
  <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system"/>
</model></sdf>"""
SPAWN = """<launch><node pkg="gazebo_ros" exec="spawn_entity.py"
  args="-entity m -file {file}"/></launch>"""


@pytest.fixture
def launched(tmp_path):
    """Return the graph of an app of files; the launch file is the first."""
    top = tmp_path / "robot"
    top.mkdir()
    (top / "package.xml").write_text("<package><name>robot</name></package>")

    def scan(files):
        write(top, files)
        launch = top / next(iter(files))
        return scan_ros2_app([top], [(launch, {})], {}, ScanOptions(workers=1))

    return scan


def ends(graph, node):
    return {
        ("> " if e.direction is Direction.PUBLISH else "< ") + e.topic
        for e in graph.endpoints
        if e.node == node and not e.implicit
    }


def test_plugins_of_a_description_are_nodes_of_their_own(launched):
    graph = launched({"app.launch.xml": LAUNCH.format(args=""), "robot.xacro": XACRO})
    assert ends(graph, "/own/drive") == {"< /own/moved", "> /odom"}
    assert ends(graph, "/laser") == {"> /scan"}
    assert {"> /eye/image_raw", "> /eye/depth/image_raw", "> /eye/points"} <= ends(
        graph, "/eye_controller"
    )
    stereo = ends(graph, "/pair_controller")
    assert {"> /stereo/left/image_raw", "> /stereo/right/camera_info"} <= stereo
    assert "> /stereo/image_raw" not in stereo
    assert "/own/drive" in {e.node for e in graph.publishers("/tf")}
    assert "/own/drive" in {e.node for e in graph.subscribers("/clock")}
    (heard,) = graph.subscribers("/own/moved")
    assert heard.type == "geometry_msgs/msg/Twist"
    assert graph.unresolved == ()


def test_the_namespace_of_the_spawner_counts_before_the_plugins(launched):
    launch = LAUNCH.format(args="-robot_namespace given")
    graph = launched({"app.launch.xml": launch, "robot.xacro": XACRO})
    assert ends(graph, "/given/drive") == {"< /given/moved", "> /odom"}
    assert ends(graph, "/given/laser") == {"> /given/scan"}


def test_plugins_of_a_file_that_is_spawned(launched):
    launch = SPAWN.format(file="$(find-pkg-share robot)/model.sdf")
    graph = launched({"app.launch.xml": launch, "model.sdf": SDF})
    assert ends(graph, "/imu") == {"> /imu/out"}
    assert ends(graph, "/states") == {"> /joint_states"}
    assert ends(graph, "/truth") == {"> /odom"}
    assert ends(graph, "/plane") == {"< /cmd_vel", "> /odom"}
    assert ends(graph, "/steer") == {"< /cmd_vel", "> /distance"}
    (imu,) = graph.publishers("/imu/out")
    assert imu.evidence[0].file.endswith("model.sdf")
    assert imu.evidence[0].line == 2
    assert [note.what for note in graph.unresolved] == ["Gazebo plugin odd"]


@pytest.mark.parametrize(
    ("file", "text", "why"),
    [
        ("/etc/passwd", SDF, "is not in the folders that are read"),
        ("$(find-pkg-share robot)/model.sdf", "<sdf", "XML"),
    ],
)
def test_a_file_that_cannot_be_read_is_noted(launched, file, text, why):
    graph = launched({"app.launch.xml": SPAWN.format(file=file), "model.sdf": text})
    (note,) = graph.unresolved
    assert note.what == "what /spawn_entity spawns"
    assert why in note.why


def test_a_description_that_nobody_publishes_is_noted(launched):
    launch = LAUNCH.format(args="").replace("-topic robot_description", "-topic /other")
    graph = launched({"app.launch.xml": launch, "robot.xacro": XACRO})
    (note,) = graph.unresolved
    assert "publishes a known description on /other" in note.why


CONTROLLED = """<robot name="r"><gazebo>
  <plugin filename="{plugin}" name="control">
    <parameters>{folder}/control.yaml</parameters>
    <ros><namespace>/bot</namespace><remapping>~/cmd_vel:=/cmd_vel</remapping></ros>
  </plugin></gazebo></robot>"""
CONTROL = """<launch>
  <node pkg="robot_state_publisher" exec="robot_state_publisher" namespace="bot">
    <param name="robot_description" value="$(command 'xacro $(find-pkg-share robot)/robot.xacro')"/>
  </node>
  {spawner}
  <node pkg="controller_manager" exec="spawner" args="base -c /bot/controller_manager"/>
</launch>"""
CONTROL_YAML = """/bot/controller_manager:
  ros__parameters:
    base: {type: diff_drive_controller/DiffDriveController}
"""
SPAWNERS = {
    "libgazebo_ros2_control.so": '<node pkg="gazebo_ros" exec="spawn_entity.py" '
    'args="-entity r -topic /bot/robot_description"/>',
    "gz_ros2_control-system": '<node pkg="ros_gz_sim" exec="create"><param name="topic" '
    'value="/bot/robot_description"/></node>',
    "libign_ros2_control-system.so": '<node pkg="ros_gz_sim" exec="create" '
    'args="-topic /bot/robot_description"/>',
}


@pytest.mark.parametrize("plugin", SPAWNERS)
def test_a_plugin_hosts_the_controller_manager(launched, tmp_path, plugin):
    robot = CONTROLLED.format(plugin=plugin, folder=tmp_path / "robot")
    launch = CONTROL.format(spawner=SPAWNERS[plugin])
    files = {"app.launch.xml": launch, "robot.xacro": robot, "control.yaml": CONTROL_YAML}
    graph = launched(files)
    assert "< /bot/robot_description" in ends(graph, "/bot/controller_manager")
    assert "< /cmd_vel" in ends(graph, "/bot/base")
    own = [node.name for node in graph.nodes if node.name.startswith("/bot/gz")]
    assert own == ([] if "gazebo" in plugin else ["/bot/gz_ros_control"])
    assert graph.unresolved == ()


def test_parameters_of_a_controller_manager_that_are_not_there_are_noted(launched):
    robot = CONTROLLED.format(plugin="gz_ros2_control-system", folder="/none")
    launch = CONTROL.format(spawner=SPAWNERS["gz_ros2_control-system"])
    graph = launched({"app.launch.xml": launch, "robot.xacro": robot})
    assert "parameters of controller_manager" in {note.what for note in graph.unresolved}
