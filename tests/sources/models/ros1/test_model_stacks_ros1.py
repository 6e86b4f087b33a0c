"""The larger models of ROS 1: arms, mapping, drones and bridges, by the parameters of a launch."""

import pytest
from model_cases import frames, names, site, told

from rtron.sources.models import load_models, node_interface

MODELS = load_models()


def modelled(name, /, **at):
    return node_interface(MODELS.node(*name.split("/")), site(**at), models=MODELS)


ARM = {
    "moveit_controller_manager": "moveit_simple_controller_manager/MoveItSimpleControllerManager",
    "controller_list": [
        {"name": "arm", "action_ns": "follow_joint_trajectory", "type": "FollowJointTrajectory"},
        {"name": "/hand", "action_ns": "", "type": "GripperCommand"},
    ],
    "sensors": [
        {"sensor_plugin": "occupancy_map_monitor/PointCloudOctomapUpdater"}
        | {"point_cloud_topic": "/depth/points", "filtered_cloud_topic": "left", "ns": "eye"},
        {"sensor_plugin": "~"},
    ],
    "planning_pipelines": {
        "ompl": {"planning_plugin": "ompl_interface/OMPLPlanner"},
        "pilz": {"capabilities": "pilz_industrial_motion_planner/MoveGroupSequenceAction"},
    },
    "disable_capabilities": "move_group/MoveGroupPickPlaceAction move_group/ClearOctomapService",
}


FOLLOWED = "/r/arm/follow_joint_trajectory"


def test_an_arm_commands_the_controllers_of_its_list():
    values = {f"/r/move_group/{name}": value for name, value in ARM.items()}
    found = modelled("moveit_ros_move_group/move_group", name="/r/move_group", values=values)
    assert told(found) >= {
        ("action_client", FOLLOWED, "control_msgs/FollowJointTrajectoryAction"),
        ("action_client", "/hand", "control_msgs/GripperCommandAction"),
        ("action_server", "/r/move_group", "moveit_msgs/MoveGroupAction"),
        ("action_server", "/r/sequence_move_group", "moveit_msgs/MoveGroupSequenceAction"),
        ("publish", "/r/move_group/eye/left", "sensor_msgs/PointCloud2"),
        ("subscribe", "/depth/points", "sensor_msgs/PointCloud2"),
        ("subscribe", "/r/joint_states", "sensor_msgs/JointState"),
        ("service", "/r/compute_ik", "moveit_msgs/GetPositionIK"),
    }
    assert "/r/move_group/planning_pipelines/ompl/ompl/set_parameters" in names(found, "service")
    assert not {"/r/pickup", "/r/place"} & names(found, "action_server")
    assert "/r/clear_octomap" not in names(found, "service")
    assert found.unresolved == ()


def test_an_arm_with_a_plugin_that_is_not_known_says_so():
    values = {"/move_group/capabilities": "my/Capability move_group/MoveGroupMoveAction"}
    found = modelled("moveit_ros_move_group/move_group", name="/move_group", values=values)
    assert [note.what for note in found.unresolved] == ["plugin:my/Capability"]
    assert names(found, "action_client") == set()


LUA = """include "base.lua"
options.num_laser_scans = 1 -- options.num_laser_scans = 3
--[[ options.use_odometry = false ]]
TRAJECTORY_BUILDER_2D.use_imu_data = false
return options
"""
BASE_LUA = """options = { map_frame = "map", published_frame = 'odom', provide_odom_frame = false,
  num_laser_scans = 0, num_point_clouds = 2, use_odometry = true, use_nav_sat = USE_GPS }
"""


@pytest.fixture
def lua_args(tmp_path):
    (tmp_path / "robot.lua").write_text(LUA)
    (tmp_path / "base.lua").write_text(BASE_LUA)
    return f"-configuration_directory {tmp_path} -configuration_basename robot.lua"


def test_cartographer_hears_what_its_settings_say(lua_args):
    found = modelled("cartographer_ros/cartographer_node", name="/map", args=lua_args)
    heard = names(found, "subscribe") - {"/tf", "/tf_static"}
    assert heard == {"/scan", "/points2_1", "/points2_2", "/odom", "/fix"}
    assert frames(found) == [("odom", "map")]
    assert [note.why for note in found.unresolved] == ["not known"]


def test_cartographer_without_its_settings_notes_that_they_are_missing():
    args = "-configuration_directory /nowhere -configuration_basename robot.lua"
    found = modelled("cartographer_ros/cartographer_node", args=args)
    assert names(found, "subscribe") == {"/tf", "/tf_static"}
    assert [note.why for note in found.unresolved] == ["its configuration robot.lua is not here"]


def test_a_joystick_sends_what_its_commands_say():
    teleop = {
        "walk": {"type": "topic", "topic_name": "cmd_vel", "message_type": "geometry_msgs/Twist"},
        "home": {"type": "action", "action_name": "/go_home"},
        "stop": {"type": "service", "service_name": "stop"},
    }
    found = modelled("joy_teleop/joy_teleop.py", name="/r/joy", values={"/r/teleop": teleop})
    assert told(found) == {
        ("publish", "/r/cmd_vel", "geometry_msgs/Twist"),
        ("action_client", "/go_home", ""),
        ("service_client", "/r/stop", ""),
        ("subscribe", "/r/joy", "sensor_msgs/Joy"),
    }


def drone(values=None):
    given = {f"/mavros/{name}": value for name, value in (values or {}).items()}
    return modelled("mavros/mavros_node", name="/mavros", values=given)


def plugins_told(found):
    both = names(found, "publish") | names(found, "subscribe")
    return {name.split("/")[2] for name in both if name.startswith("/mavros/")}


def test_a_drone_has_its_plugins():
    found = drone()
    assert told(found) >= {
        ("publish", "/mavros/state", "mavros_msgs/State"),
        ("publish", "/mavros/local_position/pose", "geometry_msgs/PoseStamped"),
        ("subscribe", "/mavros/setpoint_velocity/cmd_vel", "geometry_msgs/TwistStamped"),
        ("subscribe", "/mavros/rc/override", "mavros_msgs/OverrideRCIn"),
        ("service", "/mavros/cmd/arming", "mavros_msgs/CommandBool"),
        ("subscribe", "/mavlink/to", "mavros_msgs/Mavlink"),
    }
    assert ("map_ned", "map") in frames(found)


def test_plugins_of_a_second_package_are_uncertain():
    by_name = {d.name: d.resolution.value for d in drone().declarations}
    assert by_name["/mavros/vision_pose/pose"] == "symbolic"
    assert by_name["/mavros/setpoint_position/local"] == "model"


def test_a_plugin_of_a_second_package_that_a_list_names_is_there():
    found = drone({"plugin_whitelist": ["vision_pose_estimate", "vision_*"]})
    by_name = {d.name: d.resolution.value for d in found.declarations}
    assert by_name["/mavros/vision_pose/pose"] == "model"
    assert by_name["/mavros/vision_speed/speed_twist_cov"] == "symbolic"


@pytest.mark.parametrize(
    ("values", "present", "absent"),
    [
        ({"plugin_blacklist": ["setpoint_*", "SYS_*"]}, {"imu"}, {"setpoint_raw", "state"}),
        ({"plugin_whitelist": ["sys_*", "imu"]}, {"state", "imu"}, {"setpoint_raw", "rc"}),
        ({"plugin_blacklist": ["*"], "plugin_whitelist": ["setpoint_raw"]}, {"setpoint_raw"},
         {"imu", "state"}),
    ],
)  # fmt: skip
def test_lists_switch_plugins_on_and_off(values, present, absent):
    told_of = plugins_told(drone(values))
    assert present <= told_of
    assert not absent & told_of


def test_a_plugin_listens_to_what_its_parameters_say():
    values = {
        "setpoint_position/tf/listen": True,
        "setpoint_attitude/use_quaternion": True,
        "local_position/tf/send": True,
        "distance_sensor": {"base_frame_id": "b", "down": {"id": 0}, "up": {"id": 1}}
        | {"up": {"id": 1, "subscriber": True}},
    }
    found = drone(values)
    assert "/mavros/setpoint_position/local" not in names(found, "subscribe")
    assert "/mavros/setpoint_attitude/attitude" in names(found, "subscribe")
    assert "/mavros/distance_sensor/down" in names(found, "publish")
    assert "/mavros/distance_sensor/up" in names(found, "subscribe")
    assert ("base_link", "map") in frames(found)


@pytest.mark.parametrize(
    ("values", "heard"),
    [
        ({}, {"rgb/image", "depth/image", "rgb/camera_info", "odom"}),
        ({"subscribe_rgbd": True, "odom_frame_id": "o"}, {"rgbd_image"}),
        ({"subscribe_rgbd": True, "rgbd_cameras": 2}, {"rgbd_image0", "rgbd_image1", "odom"}),
        ({"subscribe_depth": False, "subscribe_rgb": False, "subscribe_scan": True},
         {"scan", "odom"}),
        (
            {"subscribe_stereo": True},
            {
                f"{side}/{name}"
                for side in ("left", "right")
                for name in ("image_rect", "camera_info")
            }
            | {"odom"},
        ),
    ],
)  # fmt: skip
def test_a_mapper_hears_one_kind_of_camera(values, heard):
    given = {f"/r/rtabmap/{name}": value for name, value in values.items()}
    found = modelled("rtabmap_slam/rtabmap", name="/r/rtabmap", values=given)
    kinds = {"rgb", "depth", "left", "right", "odom", "scan", "scan_cloud"}
    cameras = {
        name.removeprefix("/r/")
        for name in names(found, "subscribe")
        if set(name.split("/")[2:3]) & kinds or "rgbd" in name
    }
    assert cameras == heard


@pytest.mark.parametrize("package", ["rtabmap_odom", "rtabmap_ros"])
def test_messages_are_of_the_package_of_their_release(package):
    found = modelled(f"{package}/rgbd_odometry", name="/odometry")
    messages = "rtabmap_msgs" if package == "rtabmap_odom" else "rtabmap_ros"
    assert ("publish", "/odom_info", f"{messages}/OdomInfo") in told(found)


def test_a_bridge_says_what_it_lets_through():
    values = {"/bridge/client_topic_whitelist": ["/joy"]}
    found = modelled("foxglove_bridge/foxglove_bridge", name="/bridge", values=values)
    (note,) = found.unresolved
    assert "client_topic_whitelist ['/joy']" in note.why
    assert found.declarations == ()


def test_firmware_has_at_least_the_topics_that_are_required_of_it():
    values = {"/serial/require/publishers": ["/imu"], "/serial/require/subscribers": ["/cmd"]}
    found = modelled("rosserial_server/serial_node", name="/serial", values=values)
    assert told(found) == {("publish", "/imu", ""), ("subscribe", "/cmd", "")}
    assert MODELS.node("rosserial_server", "serial_node").unread


def test_a_filter_s_topics_are_below_what_its_sensor_is_called():
    remaps = [("/imu", "/camera/imu")]
    found = modelled("imu_filter_madgwick/imu_filter_node", name="/filter", remaps=remaps)
    assert {"/camera/imu/data_raw", "/camera/imu/mag"} <= names(found, "subscribe")
    assert "/camera/imu/data" in names(found, "publish")


def test_a_pair_of_cameras_is_rectified_and_matched():
    found = modelled("stereo_image_proc/stereo_image_proc", name="/eyes/stereo_image_proc")
    assert {"/eyes/left/image_raw", "/eyes/right/camera_info"} <= names(found, "subscribe")
    assert {"/eyes/left/image_rect", "/eyes/disparity", "/eyes/points2"} <= names(found, "publish")
    assert "/eyes/stereo_image_proc_debayer_left/set_parameters" in names(found, "service")


def test_all_names_of_a_mapper_but_its_map_are_private():
    found = modelled("slam_toolbox/async_slam_toolbox_node", name="/r/slam")
    assert told(found) >= {
        ("publish", "/map", "nav_msgs/OccupancyGrid"),
        ("subscribe", "/scan", "sensor_msgs/LaserScan"),
        ("service", "/r/slam/save_map", "slam_toolbox_msgs/SaveMap"),
        ("publish", "/r/slam_toolbox/update", "visualization_msgs/InteractiveMarkerUpdate"),
    }
