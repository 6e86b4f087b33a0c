import pytest
from file_tree import write

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import scan_app
from rtron.vocabulary import Direction

URDF = """<robot name="r"><link name="base"/>
<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
<commandTopic>cmd_vel</commandTopic><odometryTopic>odom</odometryTopic></plugin></gazebo>
<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>
<gazebo><plugin name="mine" filename="libmine.so"/></gazebo></robot>
"""
WORLD = """<sdf version="1.6"><world name="w">
<plugin name="sky" filename="libsky.so"/></world></sdf>
"""
TYPE = "position_controllers/JointPositionController"
CONTROLLERS = f"arm:\n  type: {TYPE}\n  joint: j\n"
GAZEBO = '<node pkg="gazebo_ros" type="gzserver" name="gazebo" args="-e ode {world}"/>'
SPAWN = '<node pkg="gazebo_ros" type="spawn_model" name="spawn" args="-urdf -model r {args}"/>'
DESCRIPTION = '<param name="robot_description" textfile="{folder}/r.urdf"/>'


@pytest.fixture
def scanned(tmp_path):
    write(tmp_path, {"r.urdf": URDF, "w.world": WORLD, "arm.yaml": CONTROLLERS})

    def scan(*elements):
        body = "".join(elements).replace("{folder}", str(tmp_path))
        (tmp_path / "sim.launch").write_text(f"<launch>{body}</launch>")
        launches = [(tmp_path / "sim.launch", {})]
        return scan_app([tmp_path], launches, {}, ScanOptions(workers=1)).graph

    return scan


def subscribed(graph, node="/gazebo"):
    return {
        e.topic for e in graph.endpoints if e.node == node and e.direction is Direction.SUBSCRIBE
    }


def notes(graph):
    return {note.what: note for note in graph.unresolved}


def test_plugins_of_a_spawned_robot_are_gazebos(scanned):
    graph = scanned(
        DESCRIPTION, GAZEBO.format(world=""), SPAWN.format(args="-param robot_description")
    )
    assert "/cmd_vel" in subscribed(graph)
    command = next(e for e in graph.endpoints if e.node == "/gazebo" and e.topic == "/cmd_vel")
    assert command.evidence[0].file.endswith("sim.launch")
    assert command.evidence[0].line == 1
    assert "/controller_manager/load_controller" in {s.name for s in graph.services}
    assert notes(graph)["Gazebo plugin mine"].why == "no model of it"


def test_a_robot_lives_in_its_spawners_namespace_or_the_one_that_it_gives(scanned):
    spawn = SPAWN.format(args="-param robot_description")
    graph = scanned(f'<group ns="a">{DESCRIPTION}{spawn}</group>', GAZEBO.format(world=""))
    assert "/a/cmd_vel" in subscribed(graph)
    given = SPAWN.format(args="-param robot_description -robot_namespace b")
    graph = scanned(DESCRIPTION, given, GAZEBO.format(world=""))
    assert "/b/cmd_vel" in subscribed(graph)
    assert "/cmd_vel" not in subscribed(graph)


def test_a_robot_from_a_file(scanned):
    graph = scanned(GAZEBO.format(world=""), SPAWN.format(args="-file {folder}/r.urdf"))
    command = next(e for e in graph.endpoints if e.node == "/gazebo" and e.topic == "/cmd_vel")
    assert command.evidence[0].file.endswith("r.urdf")
    assert command.evidence[0].line == 2


def test_a_description_that_nobody_in_the_launch_spawns_may_be(scanned):
    graph = scanned(DESCRIPTION, GAZEBO.format(world=""))
    assert "/cmd_vel" in subscribed(graph)


def test_without_gazebo_a_description_does_nothing(scanned):
    assert scanned(DESCRIPTION, SPAWN.format(args="-param robot_description")).topics == ()


@pytest.mark.parametrize("args", ["-param none", "-file /nowhere.urdf", "-database cube"])
def test_a_robot_that_is_not_known_is_noted(scanned, args):
    graph = scanned(GAZEBO.format(world=""), SPAWN.format(args=args))
    assert any(what.startswith(("description", "model of")) for what in notes(graph))


def test_plugins_of_the_world(scanned):
    graph = scanned(GAZEBO.format(world="{folder}/w.world"))
    (place,) = notes(graph)["Gazebo plugin sky"].evidence
    assert place.file.endswith("w.world")
    assert "world worlds/none.world" in notes(scanned(GAZEBO.format(world="worlds/none.world")))


@pytest.mark.parametrize("given", ["arm", "{folder}/arm.yaml"])
def test_controllers_are_their_hosts(scanned, given):
    graph = scanned(
        DESCRIPTION,
        '<rosparam command="load" file="{folder}/arm.yaml"/>',
        GAZEBO.format(world=""),
        SPAWN.format(args="-param robot_description"),
        f'<node pkg="controller_manager" type="spawner" name="load" args="{given}"/>',
    )
    assert "/arm/command" in subscribed(graph)
    assert "/arm/command" not in subscribed(graph, "/load")


def test_parameters_of_a_controller_file_need_not_be_loaded(scanned):
    graph = scanned(
        GAZEBO.format(world=""),
        '<node pkg="controller_manager" type="spawner" name="load" args="{folder}/arm.yaml"/>',
    )
    assert "/arm/command" in subscribed(graph)


def test_a_launch_file_that_rosbridge_brings(scanned):
    bridge = "$(find rosbridge_server)/launch/rosbridge_websocket.launch"
    graph = scanned(f'<include file="{bridge}"><arg name="port" value="9091"/></include>')
    assert {"/rosbridge_websocket", "/rosapi"} <= {node.name for node in graph.nodes}
    assert "/rosapi/get_param" in {service.name for service in graph.services}


@pytest.mark.parametrize(
    ("autopilot", "has_actuators"), [("px4.launch", True), ("apm.launch", False)]
)
def test_a_launch_file_that_mavros_brings(scanned, autopilot, has_actuators):
    graph = scanned(f'<include file="$(find mavros)/launch/{autopilot}"/>')
    assert {"/mavros/setpoint_velocity/cmd_vel", "/mavros/rc/override"} <= subscribed(
        graph, "/mavros"
    )
    assert ("/mavros/actuator_control" in subscribed(graph, "/mavros")) == has_actuators
    assert "/mavros/cmd/arming" in {service.name for service in graph.services}


CAMERA = "$(find realsense2_camera)/launch/rs_camera.launch"


def test_a_launch_file_that_realsense_brings(scanned):
    graph = scanned(
        f'<include file="{CAMERA}"><arg name="enable_gyro" value="true"/>'
        '<arg name="camera" value="eye"/></include>'
    )
    topics = {end.topic for end in graph.endpoints if end.node == "/eye/realsense2_camera_manager"}
    assert {"/eye/color/image_raw", "/eye/gyro/sample", "/eye/gyro/imu_info"} <= topics
    assert "/eye/accel/sample" not in topics


def test_another_launch_file_of_a_package_that_is_known_in_part(scanned):
    (note,) = scanned(f'<include file="{CAMERA.replace("rs_camera", "rs_other")}"/>').unresolved
    package = "realsense2_camera"
    assert (note.why, note.package) == (f"package '{package}' is not found", package)
    assert not note.missing
