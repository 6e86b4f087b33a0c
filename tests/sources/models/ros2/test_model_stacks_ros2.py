"""The larger models of ROS 2: arms, mapping, drones and bridges, by the parameters of a launch."""

import pytest
from model_cases import frames, names, ros2_node_site, told

from rtron.sources.models import ROS2_LIBRARY, load_models, node_interface
from rtron.vocabulary import QoS, Reliability

MODELS = load_models(ROS2_LIBRARY)


def modelled(type, /, **at):
    return node_interface(MODELS.node(*type.split("/")), ros2_node_site(**at), models=MODELS)


def component(type, /, **at):
    return node_interface(MODELS.component(type), ros2_node_site(**at), models=MODELS)


def nodes_of(found, name):
    return {d.node for d in found.declarations if d.name == name}


ARM = {
    "moveit_controller_manager": "moveit_simple_controller_manager/MoveItSimpleControllerManager",
    "moveit_simple_controller_manager.controller_names": ["arm", "hand"],
    "moveit_simple_controller_manager.arm.type": "FollowJointTrajectory",
    "moveit_simple_controller_manager.arm.action_ns": "follow_joint_trajectory",
    "moveit_simple_controller_manager.hand.type": "GripperCommand",
    "sensors": ["eye", "broken"],
    "eye.sensor_plugin": "occupancy_map_monitor/PointCloudOctomapUpdater",
    "eye.point_cloud_topic": "/depth/points",
    "eye.filtered_cloud_topic": "left",
    "broken.sensor_plugin": "~",
    "planning_pipelines": ["pilz"],
    "pilz.capabilities": "pilz_industrial_motion_planner/MoveGroupSequenceAction",
    "disable_capabilities": "move_group/ClearOctomapService",
}


FOLLOWED = "/r/arm/follow_joint_trajectory"


@pytest.mark.parametrize(
    ("distribution", "owner"),
    [("humble", "/r/move_group"), ("jazzy", "/r/moveit_simple_controller_manager")],
)
def test_an_arm_commands_the_controllers_of_its_list(distribution, owner):
    found = modelled(
        "moveit_ros_move_group/move_group",
        name="/r/move_group",
        settings={"/**": ARM},
        environ=[("ROS_DISTRO", distribution)],
    )
    assert told(found) >= {
        ("action_client", FOLLOWED, "control_msgs/action/FollowJointTrajectory"),
        ("action_client", "/r/hand", "control_msgs/action/GripperCommand"),
        ("action_server", "/r/move_action", "moveit_msgs/action/MoveGroup"),
        ("action_server", "/r/sequence_move_group", "moveit_msgs/action/MoveGroupSequence"),
        ("publish", "/r/left", "sensor_msgs/msg/PointCloud2"),
        ("subscribe", "/depth/points", "sensor_msgs/msg/PointCloud2"),
        ("service", "/r/compute_ik", "moveit_msgs/srv/GetPositionIK"),
    }
    assert nodes_of(found, "/r/hand") == {owner}
    assert "/r/clear_octomap" not in names(found, "service")
    assert found.unresolved == ()


def test_an_arm_with_a_plugin_that_is_not_known_says_so():
    settings = {"capabilities": "my/Capability move_group/MoveGroupMoveAction"}
    found = modelled("moveit_ros_move_group/move_group", settings={"/**": settings})
    assert [note.what for note in found.unresolved] == ["plugin:my/Capability"]
    assert names(found, "action_client") == set()


@pytest.fixture
def lua_args(tmp_path):
    (tmp_path / "robot.lua").write_text('include "base.lua"\noptions.num_laser_scans = 2\n')
    (tmp_path / "base.lua").write_text(
        'options = {map_frame = "map", odom_frame = "odom", published_frame = "base_link",\n'
        "provide_odom_frame = true, num_point_clouds = 1, use_odometry = true}\n"
        "TRAJECTORY_BUILDER_2D.use_imu_data = false\n"
    )
    return f"-configuration_directory {tmp_path} -configuration_basename robot.lua"


def test_cartographer_hears_what_its_settings_say(lua_args):
    found = modelled("cartographer_ros/cartographer_node", name="/map", args=lua_args)
    heard = names(found, "subscribe") - {"/tf", "/tf_static"}
    assert heard == {"/scan_1", "/scan_2", "/points2", "/odom"}
    assert frames(found) == [("odom", "map"), ("base_link", "odom")]
    assert found.unresolved == ()


def test_cartographer_without_its_settings_notes_that_they_are_missing():
    args = "-configuration_directory /nowhere -configuration_basename robot.lua"
    found = modelled("cartographer_ros/cartographer_node", args=args)
    assert names(found, "subscribe") <= {"/tf", "/tf_static", "/parameter_events"}
    assert [note.why for note in found.unresolved] == ["its configuration robot.lua is not here"]


def test_a_joystick_sends_what_its_commands_say():
    walk = {"type": "topic", "topic_name": "cmd_vel", "interface_type": "geometry_msgs/msg/Twist"}
    home = {"type": "action", "action_name": "/go_home", "interface_type": "my/action/Go"}
    stop = {"type": "service", "service_name": "stop", "interface_type": "std_srvs/srv/Empty"}
    groups = {"walk": walk, "home": home, "stop": stop}
    settings = {f"{name}.{key}": v for name, group in groups.items() for key, v in group.items()}
    found = modelled("joy_teleop/joy_teleop", name="/r/teleop", settings={"/**": settings})
    assert told(found) >= {
        ("publish", "/r/cmd_vel", "geometry_msgs/msg/Twist"),
        ("action_client", "/go_home", "my/action/Go"),
        ("service_client", "/r/stop", "std_srvs/srv/Empty"),
        ("subscribe", "/r/joy", "sensor_msgs/msg/Joy"),
    }


@pytest.mark.parametrize(
    ("name", "named", "router", "state", "command"),
    [
        ("/mavros_node", False, "/mavros_router", "/mavros", "/mavros/cmd"),
        ("/drone/mavros_node", False, "/drone/mavros_router", "/drone", "/drone/cmd"),
        ("/mavros/mavros", True, "/mavros/mavros", "/mavros", "/mavros/mavros"),
    ],
)
def test_a_drone_has_a_router_and_a_node_for_each_plugin(name, named, router, state, command):
    found = modelled("mavros/mavros_node", name=name, named=named)
    assert told(found) >= {
        ("publish", f"{state}/state", "mavros_msgs/msg/State"),
        ("service", f"{command}/arming", "mavros_msgs/srv/CommandBool"),
        ("subscribe", "/uas1/mavlink_sink", "mavros_msgs/msg/Mavlink"),
        ("publish", "/uas1/mavlink_sink", "mavros_msgs/msg/Mavlink"),
    }
    assert router in {made.name for made in found.nodes}
    assert ("map_ned", "map") in frames(found)


def test_plugins_of_a_second_package_are_uncertain():
    found = modelled("mavros/mavros_node", name="/mavros_node", named=False)
    by_name = {d.name: d.resolution.value for d in found.declarations}
    assert by_name["/mavros/vision_pose/pose"] == "symbolic"
    assert by_name["/mavros/setpoint_position/local"] == "model"


def test_a_plugin_of_a_second_package_that_a_list_names_is_there():
    settings = {"/mavros": {"plugin_allowlist": ["vision_pose", "vision_*"]}}
    found = modelled("mavros/mavros_node", name="/mavros_node", named=False, settings=settings)
    by_name = {d.name: d.resolution.value for d in found.declarations}
    assert by_name["/mavros/vision_pose/pose"] == "model"
    assert by_name["/mavros/vision_speed/speed_twist"] == "symbolic"


@pytest.mark.parametrize(
    ("settings", "present", "absent"),
    [
        ({"plugin_denylist": ["setpoint_*", "sys_*"]}, {"imu"}, {"setpoint_raw", "state"}),
        ({"plugin_allowlist": ["sys_*", "imu"]}, {"state", "imu"}, {"setpoint_raw", "rc"}),
        ({"plugin_denylist": ["*"], "plugin_allowlist": ["setpoint_raw"]}, {"setpoint_raw"},
         {"imu", "state"}),
    ],
)  # fmt: skip
def test_lists_switch_plugins_on_and_off(settings, present, absent):
    at = {"name": "/m/mavros_node", "named": False, "settings": {"/**": settings}}
    found = modelled("mavros/mavros_node", **at)
    both = names(found, "publish") | names(found, "subscribe")
    plugins = {name.split("/")[2] for name in both if name.startswith("/m/")}
    assert present <= plugins
    assert not absent & plugins


def test_a_plugin_has_the_parameters_of_its_own_node():
    settings = {"/mavros/local_position": {"tf.send": True, "tf.child_frame_id": "drone"}}
    at = {"name": "/mavros_node", "named": False, "settings": settings}
    found = modelled("mavros/mavros_node", **at)
    assert ("drone", "map") in frames(found)


def test_a_drone_s_parts_run_in_a_container_as_well():
    uas = component("mavros::uas::UAS", name="/mavros", settings={"/**": {"uas_url": "/uas7"}})
    assert {"/mavros/state", "/uas7/mavlink_sink"} <= names(uas, "publish")
    settings = {"/**": {"uas_urls": ["/uas7", "/uas8"]}}
    router = component("mavros::router::Router", name="/router", settings=settings)
    heard = names(router, "subscribe")
    assert {"/uas7/mavlink_sink", "/uas8/mavlink_sink"} <= heard


@pytest.mark.parametrize(
    ("settings", "heard"),
    [
        ({}, {"rgb/image", "rgb/camera_info", "depth/image", "odom"}),
        ({"subscribe_rgbd": True, "odom_frame_id": "o"}, {"rgbd_image"}),
        ({"subscribe_rgbd": True, "rgbd_cameras": 2}, {"rgbd_image0", "rgbd_image1", "odom"}),
        ({"subscribe_depth": False, "subscribe_rgb": False, "subscribe_scan": True},
         {"scan", "odom"}),
    ],
)  # fmt: skip
def test_a_mapper_hears_one_kind_of_camera(settings, heard):
    found = modelled("rtabmap_slam/rtabmap", name="/r/rtabmap", settings={"/**": settings})
    kinds = {"rgb", "depth", "left", "right", "odom", "scan", "scan_cloud"}
    inputs = {
        name.removeprefix("/r/")
        for name in names(found, "subscribe")
        if name.split("/")[2:3] and (name.split("/")[2] in kinds or "rgbd" in name)
    }
    assert inputs == heard


def test_the_quality_of_a_mapper_s_inputs_is_a_parameter():
    settings = {"subscribe_scan": True, "qos_scan": 2, "topic_queue_size": 3}
    found = modelled("rtabmap_slam/rtabmap", name="/r/rtabmap", settings={"/**": settings})
    quality = {d.name: d.qos for d in found.declarations if d.kind.value == "subscribe"}
    assert quality["/r/scan"] == QoS(depth=3, reliability=Reliability.BEST_EFFORT)


def test_bridges_say_what_is_not_known_of_them():
    settings = {"client_topic_whitelist": ["/joy"]}
    found = modelled("foxglove_bridge/foxglove_bridge", settings={"/**": settings})
    (note,) = found.unresolved
    assert "client_topic_whitelist ['/joy']" in note.why
    assert MODELS.node("micro_ros_agent", "micro_ros_agent").unread
    assert modelled("micro_ros_agent/micro_ros_agent").unresolved


def test_an_executable_s_own_name_is_part_of_its_topics():
    found = modelled("aruco_ros/single", name="/r/aruco_single")
    assert ("publish", "/r/aruco_single/pose", "geometry_msgs/msg/PoseStamped") in told(found)


@pytest.mark.parametrize(
    ("name", "heard", "said"),
    [
        ("velodyne_pointcloud/velodyne_transform_node", "velodyne_packets", "velodyne_points"),
        ("urg_node/urg_node_driver", None, "scan"),
        ("imu_filter_madgwick/imu_filter_madgwick_node", "imu/data_raw", "imu/data"),
        ("nmea_navsat_driver/nmea_topic_driver", "nmea_sentence", "fix"),
        ("octomap_server/octomap_server_node", "cloud_in", "octomap_binary"),
        ("apriltag_ros/apriltag_node", "camera_info", "detections"),
    ],
)
def test_sensors_and_filters(name, heard, said):
    found = modelled(name, name="/r/node")
    assert heard is None or f"/r/{heard}" in names(found, "subscribe")
    assert f"/r/{said}" in names(found, "publish")
