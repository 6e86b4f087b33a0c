"""Models against what running systems showed: every endpoint, none too many.

AutoRally (Melodic) and TurtleBot (Kinetic) of the ROSDiscover evaluation; parameters and plugin
values are set as those systems' launch files and descriptions set them.
"""

import pytest
from model_cases import parameters, site
from observed_systems import autorace, modelled, observed

from rtron.sources.gazebo import read_plugins
from rtron.sources.models import (
    PluginElement,
    controller_interface,
    load_models,
    node_interface,
    plugin_interface,
)
from rtron.sources.models.packages import known_packages
from rtron.sources.xacro import evaluate_xacro

KINETIC = (("ROS_DISTRO", "kinetic"),)
MELODIC = (("ROS_DISTRO", "melodic"),)


def found_at(package, executable, **at):
    return node_interface(load_models().node(package, executable), site(**at))


def nodelet_at(class_name, **at):
    return node_interface(load_models().nodelet(class_name), site(**at))


def plugin_at(filename, values, environ=KINETIC, **more):
    model = load_models().gazebo_plugin(filename)
    element = PluginElement(filename=filename, values=values, **more)
    return plugin_interface(model, site(name="/gazebo", environ=environ), element)


@pytest.mark.parametrize(
    ("system", "package", "executable", "at"),
    [
        ("turtlebot", "amcl", "amcl", {"name": "/amcl", "environ": KINETIC}),
        ("turtlebot", "map_server", "map_server", {"name": "/map_server", "environ": KINETIC}),
        ("turtlebot", "robot_state_publisher", "robot_state_publisher",
         {"name": "/robot_state_publisher"}),
        (
            "turtlebot",
            "nodelet",
            "nodelet",
            {
                "name": "/depthimage_to_laserscan",
                "args": "load depthimage_to_laserscan/X /laserscan_nodelet_manager",
            },
        ),
        ("autorally", "joy", "joy_node", {"name": "/joy_node", "environ": MELODIC}),
        ("autorally", "gazebo_ros", "gzclient", {"name": "/gazebo_gui"}),
        ("autorally", "controller_manager", "spawner", {"name": "/controller_spawner"}),
        ("autorally", "autorally_gazebo", "ground_truth_republisher.py",
         {"name": "/ground_truth_republisher"}),
    ],
)  # fmt: skip
def test_a_node_declares_what_was_observed(system, package, executable, at):
    expected = observed(system, at["name"])
    assert modelled(found_at(package, executable, **at)) == expected


COSTMAP = {
    "map_type": "voxel",
    "plugins": [
        {"name": "obstacle_layer", "type": "costmap_2d::VoxelLayer"},
        {"name": "inflation_layer", "type": "costmap_2d::InflationLayer"},
    ],
    "obstacle_layer": {
        "observation_sources": "scan bump",
        "scan": {"data_type": "LaserScan", "topic": "scan"},
        "bump": {"data_type": "PointCloud2", "topic": "mobile_base/sensors/bumper_pointcloud"},
    },
}
STATIC = {"name": "static_layer", "type": "costmap_2d::StaticLayer"}


def test_move_base():
    values = {
        "/move_base/base_local_planner": "dwa_local_planner/DWAPlannerROS",
        "/move_base/global_costmap": {**COSTMAP, "plugins": [STATIC, *COSTMAP["plugins"]]},
        "/move_base/local_costmap": COSTMAP,
    }
    expected = {
        # The subscriber asks for a Polygon; the observation gives a topic's one type to both ends.
        (kind, name, type.replace("PolygonStamped", "Polygon") if kind == "subscribe" else type)
        for kind, name, type in observed("turtlebot", "/move_base")
    }
    found = found_at("move_base", "move_base", name="/move_base", values=values, environ=KINETIC)
    remaps = [("/cmd_vel", "/navigation_velocity_smoother/raw_cmd_vel")]
    assert modelled(found, remaps=remaps) == expected
    assert found.unresolved == ()


def test_depthimage_to_laserscan_in_its_manager():
    expected = observed("turtlebot", "/laserscan_nodelet_manager")
    remaps = [("/image", "/camera/depth/image_raw")]
    manager = found_at("nodelet", "nodelet", name="/laserscan_nodelet_manager", args="manager")
    nodelet = nodelet_at(
        "depthimage_to_laserscan/DepthImageToLaserScanNodelet",
        name="/depthimage_to_laserscan",
        remaps=remaps,
    )
    assert modelled(manager, nodelet, remaps=remaps) == expected


MUX = """
subscribers:
  - {name: "Safe", topic: "input/safety_controller", timeout: 0.2, priority: 10}
  - {name: "Teleop", topic: "input/teleop", timeout: 0.5, priority: 8}
  - {name: "Switch", topic: "input/switch", timeout: 1.0, priority: 6}
  - {name: "Navi", topic: "input/navi", timeout: 1.0, priority: 5}
publisher: "output/cmd_vel"
"""


def test_the_mobile_base_manager(tmp_path):
    expected = observed("turtlebot", "/mobile_base_nodelet_manager")
    (tmp_path / "mux.yaml").write_text(MUX, encoding="utf-8")
    base, safety = "/mobile_base", "/kobuki_safety_controller"
    smoother = "/navigation_velocity_smoother"
    remaps = [
        ("/cmd_vel_mux/output/cmd_vel", f"{base}/commands/velocity"),
        (f"{safety}/cmd_vel", "/cmd_vel_mux/input/safety_controller"),
        *((f"{safety}/events/{e}", f"{base}/events/{e}") for e in ("bumper", "cliff")),
        (f"{safety}/events/wheel_drop", f"{base}/events/wheel_drop"),
        ("/bumper2pointcloud/pointcloud", f"{base}/sensors/bumper_pointcloud"),
        ("/bumper2pointcloud/core_sensors", f"{base}/sensors/core"),
        (f"{smoother}/smooth_cmd_vel", "/cmd_vel_mux/input/navi"),
        (f"{smoother}/odometry", "/odom"),
        (f"{smoother}/robot_cmd_vel", f"{base}/commands/velocity"),
    ]
    config = {"/cmd_vel_mux/yaml_cfg_file": str(tmp_path / "mux.yaml")}
    found = (
        found_at("nodelet", "nodelet", name="/mobile_base_nodelet_manager", args="manager"),
        nodelet_at("yocs_cmd_vel_mux/CmdVelMuxNodelet", name="/cmd_vel_mux", values=config),
        nodelet_at("kobuki_safety_controller/SafetyControllerNodelet", name=safety),
        nodelet_at("kobuki_bumper2pc/Bumper2PcNodelet", name="/bumper2pointcloud"),
        nodelet_at("yocs_velocity_smoother/VelocitySmootherNodelet", name=smoother),
    )
    assert modelled(*found, remaps=remaps) == expected


def described(path):
    """Return the plugins of a description that is known here."""
    packages = known_packages()
    package, _, rest = path.partition("/")
    result = evaluate_xacro(packages[package] / rest, {}, packages, {})
    assert result.unresolved == ()
    return [
        PluginElement(
            filename=plugin.filename,
            name=plugin.name,
            values=plugin.values,
            sensor_name=plugin.sensor.name if plugin.sensor else "",
            sensor_type=plugin.sensor.type if plugin.sensor else "",
        )
        for plugin in read_plugins(result.root)
    ]


def test_gazebo_with_a_turtlebot():
    expected = observed("turtlebot", "/gazebo")
    models = load_models()
    plugins = [
        plugin_interface(
            models.gazebo_plugin(element.filename), site(name="/gazebo"), element, models
        )
        for element in described("turtlebot_description/robots/kobuki_hexagons_kinect.urdf.xacro")
    ]
    world = found_at("gazebo_ros", "gzserver", name="/gazebo", environ=KINETIC)
    assert modelled(world, *plugins) == expected


AXLES = ("left_front_axle", "left_rear_axle", "right_front_axle", "right_rear_axle")
STEERED = ("left_steering", "right_steering")
SHOCKS = ("left_front_shock", "left_rear_shock", "right_front_shock", "right_rear_shock")


def camera(side):
    return plugin_at(
        "libgazebo_ros_camera.so",
        {
            "cameraName": f"{side}_camera",
            "imageTopicName": "image_raw",
            "cameraInfoTopicName": "camera_info",
        },
        sensor_type="camera",
    )


def test_gazebo_with_autorally():
    expected = observed("autorally", "/gazebo")
    types = {
        "/joint_state_controller/type": "joint_state_controller/JointStateController",
        **{f"/{a}_ctrlr/type": "effort_controllers/JointEffortController" for a in AXLES},
        **{
            f"/{p}_ctrlr/type": "effort_controllers/JointPositionController"
            for p in (*STEERED, *SHOCKS)
        },
    }
    loaded = " ".join(name.split("/")[1] for name in types)
    spawner = site(name="/controller_spawner", args=loaded)
    imu = {"topicName": "imu/imu", "serviceName": "imu/calibrate"}
    found = (
        found_at("gazebo_ros", "gzserver", name="/gazebo", environ=MELODIC),
        controller_interface(spawner, parameters(types)),
        plugin_at("libgazebo_ros_control.so", {"robotNamespace": "/"}),
        plugin_at("libgazebo_ros_p3d.so", {"topicName": "ground_truth/state_raw"}),
        plugin_at("libhector_gazebo_ros_imu.so", imu),
        plugin_at("libhector_gazebo_ros_gps.so", {"topicName": "gpsRoverStatus"}),
        camera("left"),
        camera("right"),
    )
    assert modelled(*found) == expected


def test_the_autorally_controller():
    wheels = ("left_front", "right_front", "left_rear", "right_rear")
    commanders = "OCS RC constantSpeedController joystick mppi_controller waypointFollower"
    values = {
        "/autorally_controller": {
            **{f"{w}_wheel": {"axle_controller_name": f"{w}_axle_ctrlr"} for w in wheels},
            "shock_absorbers": [{"controller_name": f"{w}_shock_ctrlr"} for w in wheels],
            "chassisCommandProirities": dict.fromkeys(commanders.split(), 1),
        },
        "/autorally_controller/left_front_wheel/steering_controller_name": "left_steering_ctrlr",
        "/autorally_controller/right_front_wheel/steering_controller_name": "right_steering_ctrlr",
    }
    expected = observed("autorally", "/autorally_controller")
    found = found_at(
        "autorally_gazebo", "autorally_controller.py", name="/autorally_controller", values=values
    )
    assert modelled(found) == expected


WAFFLE = {
    "/move_base/base_local_planner": "dwa_local_planner/DWAPlannerROS",
    "/move_base/global_costmap/static_map": True,
    **{
        f"/move_base/{costmap}_costmap/{key}": value
        for costmap in ("global", "local")
        for key, value in {
            "map_type": "costmap",
            "observation_sources": "scan",
            "scan": {"data_type": "LaserScan", "topic": "scan"},
        }.items()
    },
}
CAMERA = [("/camera/image_raw", "/camera/image")]
REPUBLISHED = [("/in", "/camera/rgb/image_raw"), ("/out", "/camera/image")]
INFO = "/camera/rgb/camera_info /camera/camera_info"


@pytest.mark.parametrize(
    ("package", "executable", "at"),
    [
        ("robot_state_publisher", "robot_state_publisher", {"name": "/robot_state_publisher"}),
        ("map_server", "map_server", {"name": "/map_server"}),
        ("amcl", "amcl", {"name": "/amcl"}),
        ("move_base", "move_base", {"name": "/move_base", "values": WAFFLE}),
        ("image_transport", "republish",
         {"name": "/republish", "args": "compressed", "remaps": REPUBLISHED}),
        ("topic_tools", "relay", {"name": "/relay_camera_info", "args": INFO}),
        ("image_proc", "image_proc", {"name": "/camera/image_proc", "remaps": CAMERA}),
    ],
)  # fmt: skip
def test_a_node_of_autorace(package, executable, at):
    listed = autorace(at["name"])
    found = found_at(package, executable, **at)
    targets = dict(at.get("remaps", []))
    names = {(kind, name) for kind, name, _ in modelled(found, remaps=targets.items())}
    explicit = {
        (str(d.kind), targets.get(d.name, d.name))
        for d in found.declarations
        if not d.implicit and d.kind in {"publish", "subscribe"}
    }
    assert listed <= names
    assert explicit <= listed


def test_gazebo_of_autorace():
    listed = autorace("/gazebo")
    models = load_models()
    plugins = [
        plugin_interface(models.gazebo_plugin(element.filename), site(name="/gazebo"), element)
        for element in described(
            "turtlebot3_description/urdf/turtlebot3_burger_for_autorace.urdf.xacro"
        )
    ]
    world = found_at("gazebo_ros", "gzserver", name="/gazebo", environ=MELODIC)
    names = {(kind, name) for kind, name, _ in modelled(world, *plugins)}
    assert listed <= names
    assert {name for _, name in names - listed if "/parameter_" not in name} == {
        *(name for kind, name in names if kind == "service"),
        "/camera/image/compressedDepth",
        "/camera/image/theora",
    }
