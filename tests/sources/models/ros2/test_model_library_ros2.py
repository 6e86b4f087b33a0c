"""Every model of ROS 2's library can be read, evaluated and followed to its source."""

import pytest
from model_cases import URDF, frames, names, ros2_node_site, told

from rtron.sources.models import ROS2_LIBRARY, load_models, node_interface
from rtron.vocabulary import QoS, Reliability, UnknownValue

MODELS = load_models(ROS2_LIBRARY)
_FOLDERS = {"publish": "msg", "subscribe": "msg", "service": "srv", "service_client": "srv"}
NODES = """
action_tutorials_cpp/fibonacci_action_client action_tutorials_cpp/fibonacci_action_server
action_tutorials_py/fibonacci_action_client action_tutorials_py/fibonacci_action_server
apriltag_ros/apriltag_node aruco_ros/double aruco_ros/marker_publisher aruco_ros/single
camera_ros/camera_node cartographer_ros/cartographer_node
cartographer_ros/cartographer_occupancy_grid_node cartographer_ros/occupancy_grid_node
controller_manager/ros2_control_node controller_manager/spawner demo_nodes_cpp/add_two_ints_client
demo_nodes_cpp/add_two_ints_client_async demo_nodes_cpp/add_two_ints_server demo_nodes_cpp/listener
demo_nodes_cpp/listener_best_effort demo_nodes_cpp/talker demo_nodes_py/add_two_ints_client
demo_nodes_py/add_two_ints_client_async demo_nodes_py/add_two_ints_server demo_nodes_py/listener
demo_nodes_py/talker depthai_ros_driver/camera_node
depthimage_to_laserscan/depthimage_to_laserscan_node diagnostic_aggregator/aggregator_node
explore_lite/explore find_object_2d/find_object_2d foxglove_bridge/foxglove_bridge
gazebo_ros/spawn_entity.py gscam/gscam_node hls_lfcd_lds_driver/hlds_laser_publisher
image_proc/rectify_node image_proc/track_marker_node image_publisher/image_publisher_node
image_rotate/image_rotate image_rotate/image_rotate_bin image_tools/cam2image image_tools/showimage
image_transport/republish image_view/image_saver image_view/image_view
imu_complementary_filter/complementary_filter_node imu_filter_madgwick/imu_filter_madgwick_node
interactive_marker_twist_server/interactive_marker_twist_server
joint_state_publisher/joint_state_publisher joint_state_publisher_gui/joint_state_publisher_gui
joy/game_controller_node joy/joy_node joy_linux/joy_linux_node joy_teleop/joy_teleop
key_teleop/key_teleop laser_filters/scan_to_scan_filter_chain ld08_driver/ld08_driver
ldlidar_stl_ros2/ldlidar_stl_ros2_node lifecycle/lifecycle_listener lifecycle/lifecycle_talker
livox_ros_driver2/livox_ros_driver2_node mavros/mavros_node micro_ros_agent/micro_ros_agent
mouse_teleop/mouse_teleop moveit_ros_move_group/move_group moveit_servo/servo_node
moveit_servo/servo_node_main multirobot_map_merge/map_merge nav2_amcl/amcl
nav2_behaviors/behavior_server nav2_bt_navigator/bt_navigator
nav2_collision_monitor/collision_monitor nav2_controller/controller_server
nav2_lifecycle_manager/lifecycle_manager nav2_loopback_sim/loopback_simulator
nav2_map_server/map_server nav2_map_server/vector_object_server nav2_planner/planner_server
nav2_route/route_server nav2_smoother/smoother_server nav2_velocity_smoother/velocity_smoother
nav2_waypoint_follower/waypoint_follower nmea_navsat_driver/nmea_serial_driver
nmea_navsat_driver/nmea_socket_driver nmea_navsat_driver/nmea_tcpclient_driver
nmea_navsat_driver/nmea_topic_driver nmea_navsat_driver/nmea_topic_serial_reader
octomap_server/color_octomap_server_node octomap_server/octomap_server_node
opennav_docking/opennav_docking orbbec_camera/orbbec_camera_node ouster_ros/os_cloud
ouster_ros/os_driver ouster_ros/os_sensor pcl_ros/filter_crop_box_node
pcl_ros/filter_extract_indices_node pcl_ros/filter_passthrough_node
pcl_ros/filter_project_inliers_node pcl_ros/filter_radius_outlier_removal_node
pcl_ros/filter_statistical_outlier_removal_node pcl_ros/filter_voxel_grid_node
pcl_ros/pcd_to_pointcloud pointcloud_to_laserscan/pointcloud_to_laserscan_node
realsense2_camera/realsense2_camera_node rf2o_laser_odometry/rf2o_laser_odometry_node
robot_localization/ekf_node robot_localization/navsat_transform_node robot_localization/ukf_node
robot_state_publisher/robot_state_publisher ros1_bridge/dynamic_bridge ros1_bridge/parameter_bridge
ros1_bridge/static_bridge ros2_aruco/aruco_node ros2action/send_goal ros2bag/play ros2bag/record
ros2lifecycle/set ros2service/call ros2topic/echo ros2topic/pub ros_gz_sim/create
ros_tcp_endpoint/default_server_endpoint rosapi/rosapi_node rosbridge_server/rosbridge_websocket
rplidar_ros/rplidar_node rqt_bag/rqt_bag rqt_console/rqt_console rqt_graph/rqt_graph
rqt_gui/rqt_gui rqt_image_view/rqt_image_view rqt_plot/rqt_plot rqt_publisher/rqt_publisher
rqt_reconfigure/rqt_reconfigure rqt_robot_steering/rqt_robot_steering
rqt_service_caller/rqt_service_caller rqt_tf_tree/rqt_tf_tree rqt_topic/rqt_topic
rslidar_sdk/rslidar_sdk_node rtabmap_odom/icp_odometry rtabmap_odom/rgbd_odometry
rtabmap_odom/stereo_odometry rtabmap_slam/rtabmap rtabmap_sync/rgbd_sync rtabmap_sync/stereo_sync
rtabmap_viz/rtabmap_viz rviz2/rviz2 sick_safetyscanners2/sick_safetyscanners2_lifecycle_node
sick_safetyscanners2/sick_safetyscanners2_node sick_scan_xd/sick_generic_caller
slam_toolbox/async_slam_toolbox_node slam_toolbox/lifelong_slam_toolbox_node
slam_toolbox/localization_slam_toolbox_node slam_toolbox/sync_slam_toolbox_node
sllidar_ros2/sllidar_node spacenav/spacenav_node stereo_image_proc/disparity_node
stereo_image_proc/point_cloud_node teleop_twist_joy/teleop_node
teleop_twist_keyboard/teleop_twist_keyboard tf2_ros/static_transform_publisher topic_tools/mux
topic_tools/relay turtlebot3_node/turtlebot3_ros turtlebot4_node/turtlebot4_node
turtlesim/draw_square turtlesim/mimic turtlesim/turtle_teleop_key turtlesim/turtlesim_node
twist_mux/joystick_relay twist_mux/joystick_relay.py twist_mux/twist_marker twist_mux/twist_mux
ublox_gps/ublox_gps_node ur_robot_driver/controller_stopper_node ur_robot_driver/dashboard_client
ur_robot_driver/robot_state_helper ur_robot_driver/trajectory_until_node
ur_robot_driver/urscript_interface urg_node/urg_node_driver usb_cam/usb_cam_node_exe
v4l2_camera/v4l2_camera_node velodyne_driver/velodyne_driver_node
velodyne_laserscan/velodyne_laserscan_node velodyne_pointcloud/velodyne_convert_node
velodyne_pointcloud/velodyne_transform_node vesc_ackermann/ackermann_to_vesc_node
vesc_driver/vesc_driver_node web_video_server/web_video_server
ydlidar_ros2_driver/ydlidar_ros2_driver_node
"""
CONTROLLERS = """
admittance_controller/AdmittanceController battery_state_broadcaster/BatteryStateBroadcaster
diff_drive_controller/DiffDriveController forward_command_controller/ForwardCommandController
gpio_controllers/GpioCommandController gps_sensor_broadcaster/GPSSensorBroadcaster
imu_sensor_broadcaster/IMUSensorBroadcaster joint_state_broadcaster/JointStateBroadcaster
joint_trajectory_controller/JointTrajectoryController
magnetometer_broadcaster/MagnetometerBroadcaster
motion_primitives_controllers/MotionPrimitivesForwardController
omni_wheel_drive_controller/OmniWheelDriveController
picknik_reset_fault_controller/PicknikResetFaultController
picknik_twist_controller/PicknikTwistController pid_controller/PidController
pose_broadcaster/PoseBroadcaster state_interfaces_broadcaster/StateInterfacesBroadcaster
ur_controllers/ForceModeController ur_controllers/FreedriveModeController
ur_controllers/FrictionModelController ur_controllers/GPIOController
ur_controllers/PassthroughTrajectoryController ur_controllers/SpeedScalingStateBroadcaster
ur_controllers/ToolContactController ur_controllers/URConfigurationController
"""


def modelled(type, /, **at):
    return node_interface(MODELS.node(*type.split("/")), ros2_node_site(**at), models=MODELS)


def test_the_library_of_ros2_has_the_nodes_and_controllers():
    assert [name for name in NODES.split() if MODELS.node(*name.split("/")) is None] == []
    assert [name for name in CONTROLLERS.split() if MODELS.controller(name) is None] == []


@pytest.mark.parametrize("name", sorted(n for kind, n in MODELS.by_name if kind == "controller"))
def test_a_controller_has_no_services_of_its_lifecycle(name):
    found = node_interface(MODELS.controller(name), ros2_node_site(name="/arm"), models=MODELS)
    names = {declared.name for declared in found.declarations}
    assert "/arm/transition_event" in names
    assert "/arm/change_state" not in names


@pytest.mark.parametrize("distribution", ["humble", "jazzy", "kilted", "rolling"])
@pytest.mark.parametrize("key", sorted(k for k in MODELS.by_name if k[0] == "node"), ids="/".join)
def test_every_node_of_ros2_is_evaluated_without_parameters(key, distribution):
    at = ros2_node_site(name="/ns/node", environ=[("ROS_DISTRO", distribution)])
    found = node_interface(MODELS.by_name[key], at, models=MODELS)
    assert all("value" not in note.why for note in found.unresolved), found.unresolved
    for declaration in found.declarations:
        assert declaration.name.startswith("/")
        assert "//" not in declaration.name
        folder = _FOLDERS.get(declaration.kind.value, "action")
        typed = declaration.type.split("/")
        assert declaration.type == "" or (len(typed), typed[1]) == (3, folder), declaration
        assert declaration.node in {made.name for made in found.nodes}


def test_every_endpoint_of_nav2_has_its_quality_of_service():
    for (kind, name), model in MODELS.by_name.items():
        nav2 = name.startswith(("nav2_", "opennav_")) and kind in {"node", "part", "plugin"}
        for entry in model.walk() if nav2 else ():
            joins = entry.publish or entry.subscribe
            assert entry.qos or not joins, (name, entry)


PLACELESS = {
    "controller_manager/spawner",
    "rviz2/rviz2",
    "position_controllers/GripperActionController",
}
"""What its command line, its file or an older release tells."""


def test_every_endpoint_of_the_newest_release_names_a_line():
    for (_, name), model in MODELS.by_name.items():
        for entry in model.walk():
            older = "not since" in (entry.condition or "") or "not kilted" in (
                entry.condition or ""
            )
            placed = entry.line or ":" in entry.at
            assert (
                entry.kind is None
                or placed
                or older
                or PLACELESS & {name, *model.node, *model.controller}
            ), (name, entry.name)


def test_a_twist_mux_of_ros2_hears_what_its_parameters_name():
    settings = {
        "topics.joy.topic": "joy_vel",
        "topics.joy.priority": 100,
        "topics.nav.topic": "/nav_vel",
        "locks.stop.topic": "e_stop",
        "use_stamped": True,
    }
    found = modelled("twist_mux/twist_mux", name="/r/mux", settings={"/**": settings})
    assert told(found) >= {
        ("subscribe", "/r/joy_vel", "geometry_msgs/msg/TwistStamped"),
        ("subscribe", "/nav_vel", "geometry_msgs/msg/TwistStamped"),
        ("subscribe", "/r/e_stop", "std_msgs/msg/Bool"),
        ("publish", "/r/cmd_vel_out", "geometry_msgs/msg/TwistStamped"),
    }
    assert len(names(found, "subscribe")) == 3


def test_a_motor_controller_is_told_by_the_node_that_takes_steering():
    told_by, driver = (
        modelled(program, name="/n")
        for program in ("vesc_ackermann/ackermann_to_vesc_node", "vesc_driver/vesc_driver_node")
    )
    assert names(told_by, "publish") < names(driver, "subscribe")
    assert names(told_by, "subscribe") == {"/ackermann_cmd"}


def test_inputs_of_a_filter_are_counted_and_heard_where_something_of_them_is_used():
    settings = {
        "odom0": "wheel/odom",
        "odom0_config": [False, True],
        "odom0_queue_size": 3,
        "odom1": "/visual",
        "imu0": "imu",
        "imu0_config": [False, False],
        "imu2": "other",
    }
    found = modelled("robot_localization/ekf_node", settings={"/robot/driver": settings})
    heard = {d.name: d.qos for d in found.declarations if d.kind.value == "subscribe"}
    assert heard["/robot/wheel/odom"] == QoS(depth=3, reliability=Reliability.BEST_EFFORT)
    assert "/visual" in heard
    assert not {"/robot/imu", "/robot/other"} & heard.keys()


def test_a_costmap_is_a_node_of_its_own_with_its_own_parameters():
    settings = {
        "/r/local_costmap/local_costmap": {
            "plugins": ["obstacles", "inflation_layer"],
            "obstacles.plugin": "nav2_costmap_2d::VoxelLayer",
            "obstacles.observation_sources": "scan cloud",
            "obstacles.scan.topic": "/front",
            "obstacles.cloud.data_type": "PointCloud2",
        },
        "/r/controller_server": {"FollowPath.plugin": "dwb_core::DWBLocalPlanner"},
    }
    found = modelled(
        "nav2_controller/controller_server", name="/r/controller_server", settings=settings
    )
    costmap = {d.name for d in found.declarations if d.node == "/r/local_costmap/local_costmap"}
    assert {"/front", "/r/cloud", "/r/local_costmap/obstacles_raw"} <= costmap
    assert "/r/map" not in costmap
    own = {d.name for d in found.declarations if d.node == "/r/controller_server"}
    assert {"/r/evaluation", "/r/cmd_vel", "/r/follow_path"} <= own


@pytest.mark.parametrize(
    ("distribution", "scan", "map"),
    [
        ("jazzy", "/r/local_costmap/scan", "/r/local_costmap/walls"),
        ("kilted", "/r/scan", "/r/walls"),
    ],
)
def test_relative_topics_of_layers_are_of_the_costmap_until_jazzy(distribution, scan, map):
    layers = {
        "plugins": ["obstacles", "walls", "static_layer"],
        "obstacles.plugin": "nav2_costmap_2d::ObstacleLayer",
        "obstacles.observation_sources": "scan",
        "walls.plugin": "nav2_costmap_2d::StaticLayer",
        "walls.map_topic": "walls",
        "static_layer.plugin": "nav2_costmap_2d::StaticLayer",
    }
    found = modelled(
        "nav2_controller/controller_server",
        name="/r/controller_server",
        settings={"/r/local_costmap/local_costmap": layers},
        environ=[("ROS_DISTRO", distribution)],
    )
    heard = {d.name for d in found.declarations if d.kind.value == "subscribe"}
    assert {scan, map, "/r/map"} <= heard


@pytest.mark.parametrize(
    ("plugin", "distribution", "heard", "published"),
    [
        ("KeepoutFilter", "jazzy", "/r/local_costmap/info", ""),
        ("KeepoutFilter", "kilted", "/r/info", ""),
        ("BinaryFilter", "jazzy", "/r/local_costmap/info", "/r/local_costmap/binary_state"),
        ("BinaryFilter", "kilted", "/r/local_costmap/info", "/r/local_costmap/binary_state"),
        ("SpeedFilter", "jazzy", "/r/local_costmap/info", "/r/local_costmap/speed_limit"),
        ("SpeedFilter", "kilted", "/r/info", "/r/speed_limit"),
        ("ZoneParameterFilter", "lyrical", "/r/info", "/r/zone_filter_state"),
        ("AsymmetricInflationLayer", "lyrical", "/r/plan", ""),
    ],
)
def test_topics_of_filters_are_joined_as_each_release_does(plugin, distribution, heard, published):
    filter = {
        "plugins": [],
        "filters": ["zone"],
        "zone.plugin": f"nav2_costmap_2d::{plugin}",
        "zone.filter_info_topic": "info",
    }
    found = modelled(
        "nav2_controller/controller_server",
        name="/r/controller_server",
        settings={"/r/local_costmap/local_costmap": filter},
        environ=[("ROS_DISTRO", distribution)],
    )
    names = {
        kind: {d.name for d in found.declarations if d.kind.value == kind}
        for kind in ("subscribe", "publish")
    }
    assert heard in names["subscribe"]
    assert {published} - {""} <= names["publish"]


@pytest.mark.parametrize(
    ("distribution", "settings", "type"),
    [
        ("humble", {}, "Twist"),
        ("jazzy", {}, "Twist"),
        ("kilted", {}, "TwistStamped"),
        ("jazzy", {"enable_stamped_cmd_vel": True}, "TwistStamped"),
        ("kilted", {"enable_stamped_cmd_vel": False}, "Twist"),
    ],
)
def test_a_velocity_is_stamped_as_the_distribution_and_the_parameters_say(
    distribution, settings, type
):
    found = modelled(
        "nav2_velocity_smoother/velocity_smoother",
        settings={"/**": settings},
        environ=[("ROS_DISTRO", distribution)],
    )
    types = {d.type for d in found.declarations if "cmd_vel" in d.name}
    assert types == {f"geometry_msgs/msg/{type}"}


@pytest.mark.parametrize(
    ("distribution", "topic"),
    [("humble", "/n/cmd_vel_unstamped"), ("jazzy", "/n/cmd_vel"), ("", "/n/cmd_vel_unstamped")],
)
def test_a_parameter_of_older_releases_counts_where_the_distribution_may_be_one(
    distribution, topic
):
    at = ros2_node_site(
        name="/n",
        settings={"/**": {"use_stamped_vel": False}},
        environ=[("ROS_DISTRO", distribution)] if distribution else [],
    )
    found = node_interface(
        MODELS.controller("diff_drive_controller/DiffDriveController"), at, models=MODELS
    )
    assert names(found, "subscribe") == {topic}
    assert [note.what for note in found.unresolved] == (
        [] if distribution else ["the velocities that /n hears"]
    )


def test_a_node_that_its_launch_does_not_name_has_its_own_name():
    found = modelled("teleop_twist_joy/teleop_node", name="/r/teleop_node", named=False)
    assert [made.name for made in found.nodes] == ["/r/teleop_twist_joy_node"]


HUGE = ["x"] * 5000


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("twist_mux/twist_mux", {"topics.a.topic": 5, "use_stamped": True}),
        ("twist_mux/twist_mux", {"topics.a.topic": "two words"}),
        ("robot_localization/ekf_node", {"odom0": ["a"]}),
        ("robot_localization/ekf_node", {"odom0": "a", "odom0_queue_size": "many"}),
        ("nav2_controller/controller_server", {"controller_plugins": "FollowPath"}),
        ("nav2_controller/controller_server", {"controller_plugins": HUGE}),
        ("nav2_velocity_smoother/velocity_smoother", {"enable_stamped_cmd_vel": "yes"}),
        ("nav2_lifecycle_manager/lifecycle_manager", {"node_names": [["a"]]}),
        ("nav2_bt_navigator/bt_navigator", {"navigators": [1, None, {"a": 2}]}),
        ("slam_toolbox/async_slam_toolbox_node", {"map_name": {"deep": "x"}}),
        ("joint_state_publisher/joint_state_publisher", {"source_list": 3}),
        ("topic_tools/mux", {"input_topics": "a"}),
    ],
)
def test_a_parameter_of_another_kind_is_noted(name, settings):
    found = modelled(name, settings={"/**": settings})
    assert found.unresolved


def test_an_unknown_parameter_leaves_a_symbolic_name():
    unknown = {"scan_topic": UnknownValue("at run time")}
    found = modelled("nav2_amcl/amcl", settings={"/**": unknown})
    heard = [d for d in found.declarations if "LaserScan" in d.type]
    assert [d.name for d in heard] == ["/robot/{scan_topic}"]
    assert [d.resolution.value for d in heard] == ["symbolic"]


TREE = """<root main_tree_to_execute="Main"><BehaviorTree ID="Main"><Sequence>
  <ComputePathToPose goal="{goal}"/><Action ID="Dock" x="1"/><GoalUpdated/>
  <FollowPath server_name="follow_it"/><ClearEntireCostmap service_name="local/clear"/>
  <PlannerSelector topic_name="plan_with"/><IsBatteryLow/>
</Sequence></BehaviorTree></root>"""
POSE_CLIENT = "/robot/driver_navigate_to_pose_rclcpp_node"


def of_tree(path):
    given = {"/**": {"default_nav_to_pose_bt_xml": str(path), "navigators": ["navigate_to_pose"]}}
    found = modelled("nav2_bt_navigator/bt_navigator", settings=given)
    client = [d for d in found.declarations if d.node == POSE_CLIENT and not d.implicit]
    joined = {(d.kind.value, d.name, d.type.rpartition("/")[2]) for d in client}
    return joined - {("publish", "/robot/behavior_tree_log", "BehaviorTreeLog")}, found.unresolved


def test_the_nodes_of_a_tree_of_nav2(tmp_path):
    (tmp_path / "tree.xml").write_text(TREE)
    joined, notes = of_tree(tmp_path / "tree.xml")
    assert joined == {
        ("action_client", "/robot/compute_path_to_pose", "ComputePathToPose"),
        ("action_client", "/robot/follow_it", "FollowPath"),
        ("service_client", "/robot/local/clear", "ClearEntireCostmap"),
        ("subscribe", "/robot/plan_with", "String"),
        ("subscribe", "/battery_status", "BatteryState"),
    }
    assert [note.what for note in notes] == ["tree node Dock of /robot/driver"]


@pytest.mark.parametrize("path", ["", "/opt/navigate_to_pose_w_replanning_and_recovery.xml"])
def test_the_tree_that_nav2_brings(path):
    joined, notes = of_tree(path)
    assert ("action_client", "/robot/backup", "BackUp") in joined
    assert not notes


@pytest.mark.parametrize(("name", "text"), [("gone.xml", None), ("odd.xml", "<root")])
def test_a_tree_that_cannot_be_read_is_noted(tmp_path, name, text):
    if text is not None:
        (tmp_path / name).write_text(text)
    joined, (note,) = of_tree(tmp_path / name)
    assert (joined, note.what) == (set(), f"tree node {name} of /robot/driver")


RVIZ = """Visualization Manager:
  Displays:
  - Class: rviz_common/Group
    Enabled: true
    Displays:
    - {Class: rviz_default_plugins/LaserScan, Enabled: true,
       Topic: {Value: /scan, Depth: 7, Reliability Policy: Best Effort}}
    - {Class: rviz_default_plugins/Path, Enabled: false, Topic: {Value: /plan}}
  - {Class: rviz_default_plugins/Map, Enabled: true, Topic: {Value: /map},
     Update Topic: {Value: /map_updates}}
  - {Class: rviz_default_plugins/Image, Enabled: true, Topic: [1]}
  - {Class: rviz_default_plugins/RobotModel, Description Source: Topic,
     Description Topic: {Value: robot_description}}
  - {Class: rviz_default_plugins/RobotModel, Description Source: File,
     Description Topic: {Value: unheard}}
  - {Class: rviz_default_plugins/Camera, Topic: {Value: /eye/image_raw}}
  - {Class: rviz_default_plugins/DepthCloud, Depth Map Topic: /depth/image,
     Color Image Topic: /color/image}
  - {Class: rviz_default_plugins/InteractiveMarkers, Interactive Markers Namespace: /arm/}
  - {Class: rviz_default_plugins/Marker, Topic: {Value: /way}}
  Tools:
  - {Class: rviz_default_plugins/SetGoal, Topic: {Value: /goal}}
  - {Class: rviz_default_plugins/MoveCamera}
  - 3
"""


def test_an_rviz_shows_and_sends_what_its_file_says(tmp_path):
    (tmp_path / "app.rviz").write_text(RVIZ)
    found = modelled("rviz2/rviz2", args=f"-d {tmp_path}/app.rviz --ros-args -r a:=b")
    assert {t for t in told(found) if "/tf" not in t[1]} == {
        ("subscribe", "/scan", "sensor_msgs/msg/LaserScan"),
        ("subscribe", "/map", "nav_msgs/msg/OccupancyGrid"),
        ("subscribe", "/map_updates", "map_msgs/msg/OccupancyGridUpdate"),
        ("publish", "/goal", "geometry_msgs/msg/PoseStamped"),
        ("subscribe", "/robot/robot_description", "std_msgs/msg/String"),
        ("subscribe", "/eye/image_raw", "sensor_msgs/msg/Image"),
        ("subscribe", "/eye/camera_info", "sensor_msgs/msg/CameraInfo"),
        ("subscribe", "/depth/image", "sensor_msgs/msg/Image"),
        ("subscribe", "/depth/camera_info", "sensor_msgs/msg/CameraInfo"),
        ("subscribe", "/color/image", "sensor_msgs/msg/Image"),
        ("subscribe", "/way", "visualization_msgs/msg/Marker"),
        ("subscribe", "/way_array", "visualization_msgs/msg/MarkerArray"),
        ("service", "/robot/driver/reset_time", "std_srvs/srv/Empty"),
        ("subscribe", "/arm/update", "visualization_msgs/msg/InteractiveMarkerUpdate"),
        ("publish", "/arm/feedback", "visualization_msgs/msg/InteractiveMarkerFeedback"),
        (
            "service_client",
            "/arm/get_interactive_markers",
            "visualization_msgs/srv/GetInteractiveMarkers",
        ),
    }
    (scan,) = [d for d in found.declarations if d.name == "/scan"]
    assert scan.qos == QoS(depth=7, reliability=Reliability.BEST_EFFORT)


def test_a_bag_is_recorded_and_played():
    heard = modelled("ros2bag/record", args="-o out --storage mcap --topics /scan /odom -d 9")
    topics = {t[1:] for t in told(heard) if t[0] == "subscribe"}
    assert topics == {("/scan", ""), ("/odom", "")}
    assert heard.unresolved == ()
    (note,) = modelled("ros2bag/record", args="-a -o out").unresolved
    assert note.why == "it records whatever is published"
    played = modelled("ros2bag/play", args="-r 2 run.bag --clock")
    assert ("publish", "/clock", "rosgraph_msgs/msg/Clock") in told(played)
    assert [note.what for note in played.unresolved] == ["the topics in run.bag"]


@pytest.mark.parametrize(
    ("distribution", "given", "topics"),
    [
        ("humble", {}, ["/robot/driver/robot_description"]),
        ("humble", {"/**": {"robot_description": "<robot/>"}}, []),
        ("humble", {"/**": {"robot_description": UnknownValue("a command")}}, []),
        ("jazzy", {"/**": {"robot_description": "<robot/>"}}, ["/robot/robot_description"]),
    ],
)
def test_a_controller_manager_asks_for_a_description_it_is_not_given(distribution, given, topics):
    environ = [("ROS_DISTRO", distribution)]
    found = modelled("controller_manager/ros2_control_node", settings=given, environ=environ)
    assert [t[1] for t in told(found) if t[0] == "subscribe"] == topics


def test_what_clients_over_the_network_open_is_noted():
    settings = {"/**": {"topics_glob": "[/odom]"}}
    bridge = modelled("rosbridge_server/rosbridge_websocket", name="/r/web", settings=settings)
    assert told(bridge) == {
        ("publish", "/r/client_count", "std_msgs/msg/Int32"),
        ("publish", "/r/connected_clients", "rosbridge_msgs/msg/ConnectedClients"),
    }
    assert "topics_glob [/odom]" in bridge.unresolved[0].why
    assert MODELS.node("rosbridge_server", "rosbridge_websocket").unread
    video = modelled("web_video_server/web_video_server")
    assert [note.what for note in video.unresolved] == ["the images of web_video_server"]
    asked = modelled("rosapi/rosapi_node", name="/r/rosapi_node", named=False)
    assert [node.name for node in asked.nodes] == ["/r/rosapi", "/r/rosapi_params"]
    assert {name.rpartition("/")[0] for name in names(asked, "service")} == {"/rosapi"}


PANELS = """Panels:
- {Class: rviz_common/Displays}
- {Class: nav2_rviz_plugins/Navigation 2}
- 3
Visualization Manager:
  Displays: [{Class: nav2_rviz_plugins/ParticleCloud, Topic: {Value: /particle_cloud}}]
"""


def test_the_panel_of_nav2_is_a_node_that_sends_goals(tmp_path):
    (tmp_path / "app.rviz").write_text(PANELS)
    found = modelled("rviz2/rviz2", args=f"-d {tmp_path}/app.rviz")
    panel = [d for d in found.declarations if d.node.endswith("navigation_dialog_action_client")]
    assert ("action_client", "/robot/follow_waypoints", "nav2_msgs/action/FollowWaypoints") in {
        (str(d.kind), d.name, d.type) for d in panel
    }
    assert "/robot/lifecycle_manager_localization/is_active" in {d.name for d in panel}
    assert ("subscribe", "/particle_cloud", "nav2_msgs/msg/ParticleCloud") in told(found)
    (tmp_path / "app.rviz").write_text(PANELS.replace("Navigation 2", "Other"))
    other = modelled("rviz2/rviz2", args=f"-d {tmp_path}/app.rviz")
    unknown = modelled("rviz2/rviz2", args="-d /nowhere/app.rviz")
    for one in (other, unknown):
        assert not [d for d in one.declarations if str(d.kind) == "action_client"]


def test_the_panel_of_moveit_sends_goals(tmp_path):
    display = "{Class: moveit_rviz_plugin/MotionPlanning, Move Group Namespace: arm}"
    (tmp_path / "app.rviz").write_text(f"Visualization Manager: {{Displays: [{display}]}}")
    found = modelled("rviz2/rviz2", args=f"-d {tmp_path}/app.rviz")
    assert {t[1:] for t in told(found) if t[0] == "action_client"} == {
        ("/robot/arm/move_group", "moveit_msgs/action/MoveGroup"),
        ("/robot/arm/execute_trajectory", "moveit_msgs/action/ExecuteTrajectory"),
    }


def test_arguments_that_the_client_library_takes_are_not_the_nodes():
    found = modelled("topic_tools/relay", args="/in /out --ros-args -r a:=b -p x:=1")
    ends = {(d.kind.value, d.name) for d in found.declarations}
    assert ends == {("subscribe", "/in"), ("publish", "/out")}


def test_a_spawner_is_called_like_its_first_controller():
    words = "--controller-manager-timeout 10 -c /cm arm hand"
    model = MODELS.node("controller_manager", "spawner")
    found = node_interface(
        model, ros2_node_site("/ns/spawner", args=words, named=False), models=MODELS
    )
    assert [node.name for node in found.nodes] == ["/ns/spawner_arm"]


@pytest.mark.parametrize(
    ("named", "name"), [(False, "static_transform_publisher_{id}"), (True, "n")]
)
def test_a_static_transform_publisher_names_itself_anew_each_time(named, name):
    model = MODELS.node("tf2_ros", "static_transform_publisher")
    found = node_interface(model, ros2_node_site("/ns/n", named=named), models=MODELS)
    assert [node.name for node in found.nodes] == [f"/ns/{name}"]


TOOLS = {
    ("relay", "/in"): ["/in", "/sent"],
    ("relay", "/in out"): ["/in", "/ns/out"],
    ("delay", "/in 1.5"): ["/in", "/sent"],
    ("delay", "/in 1.5 /out"): ["/in", "/out"],
    ("drop", "/in 1 2"): ["/in", "/sent"],
    ("drop", "/in 1 2 /out"): ["/in", "/out"],
    ("throttle", "messages /in 1.0"): ["/in", "/sent"],
    ("throttle", "messages /in 1.0 /out"): ["/in", "/out"],
    ("throttle", "bytes /in 1024 1.0"): ["/in", "/sent"],
    ("throttle", "bytes /in 1024 1.0 /out"): ["/in", "/out"],
    ("mux", "/out /in1 in2"): ["/in1", "/ns/in2", "/out"],
    ("demux", "/in /out1 out2"): ["/in", "/out1", "/ns/out2"],
    ("transform", "/in /out std_msgs/Float64 m.x -i numpy"): ["/in", "/out"],
    ("relay_field", "in /out std_msgs/msg/Bool {data:1}"): ["/nsin", "/out"],
}
GIVEN = {"input_topic": "/given", "output_topic": "/sent"}
LISTED = {"input_topics": ("/a", "b"), "output_topics": ("/a", "b"), "initial_topic": "/c"}


def ends_of(fake_study):
    heard, sent = names(fake_study, "subscribe"), names(fake_study, "publish")
    return sorted(heard), sorted(sent)


@pytest.mark.parametrize(("tool", "words"), TOOLS)
def test_the_words_of_a_topic_tool_count_before_its_parameters(tool, words):
    site = ros2_node_site("/ns/tool", {"/**": GIVEN | LISTED | {"initial_topic": ""}}, args=words)
    found = node_interface(MODELS.node("topic_tools", tool), site, models=MODELS)
    heard, sent = ends_of(found)
    assert sorted([*heard, *sent]) == sorted(TOOLS[tool, words])
    assert found.unresolved == ()


@pytest.mark.parametrize("tool", ["relay", "delay", "drop", "throttle"])
@pytest.mark.parametrize("words", ["", "messages"])
def test_a_topic_tool_has_the_topics_of_its_parameters(tool, words):
    words = words if tool == "throttle" else ""
    model = MODELS.node("topic_tools", tool)
    found = node_interface(
        model, ros2_node_site("/ns/tool", {"/**": GIVEN}, args=words), models=MODELS
    )
    assert ends_of(found) == (["/given"], ["/sent"])
    unset = node_interface(model, ros2_node_site("/ns/tool"), models=MODELS)
    assert [note.why for note in unset.unresolved] == ["the parameter input_topic is not set"]


def test_a_topic_tool_names_its_output_after_itself_where_nothing_else_does():
    found = node_interface(
        MODELS.node("topic_tools", "drop"), ros2_node_site("/d", args="in 1 2"), models=MODELS
    )
    assert ends_of(found) == (["/in"], ["/in_drop"])


def test_a_mux_hears_and_a_demux_sends_what_it_is_set_to():
    found = node_interface(MODELS.node("topic_tools", "mux"), ros2_node_site("/m", {"/**": LISTED}))
    assert ends_of(found) == (["/a", "/b", "/c"], ["/m/selected"])
    found = node_interface(
        MODELS.node("topic_tools", "demux"), ros2_node_site("/d", {"/**": LISTED})
    )
    assert ends_of(found) == (["/d/input"], ["/a", "/b", "/c"])


def test_a_transform_has_a_name_that_ends_in_its_number():
    words = "/in /out std_msgs/Float64 m --field x"
    site = ros2_node_site("/ns/transform", args=words, named=False)
    found = node_interface(MODELS.node("topic_tools", "transform"), site, models=MODELS)
    assert [node.name for node in found.nodes] == ["/ns/transform_*"]
    assert ("publish", "/out", "std_msgs/msg/Float64") in told(found)


@pytest.mark.parametrize(
    ("name", "settings", "expected"),
    [
        ("robot_localization/ekf_node", {}, [("base_link", "odom")]),
        ("robot_localization/ekf_node", {"base_link_frame_output": "b"}, [("b", "odom")]),
        ("robot_localization/ukf_node", {"world_frame": "map"}, [("odom", "map")]),
        ("robot_localization/ekf_node", {"world_frame": "utm"}, []),
        ("robot_localization/ekf_node", {"publish_tf": False}, []),
        ("nav2_amcl/amcl", {"odom_frame_id": "o"}, [("o", "map")]),
        ("nav2_amcl/amcl", {"tf_broadcast": False}, []),
        ("slam_toolbox/async_slam_toolbox_node", {}, [("odom", "map")]),
        ("slam_toolbox/async_slam_toolbox_node", {"transform_publish_period": 0.0}, []),
        ("turtlebot3_node/turtlebot3_ros", {}, []),
        ("turtlebot3_node/turtlebot3_ros", {"odometry.publish_tf": True, "namespace": "r"},
         [("r/base_footprint", "r/odom")]),
        ("robot_state_publisher/robot_state_publisher",
         {"robot_description": URDF, "frame_prefix": "r/"},
         [("r/laser", "r/base"), ("r/arm", "r/base")]),
    ],
)  # fmt: skip
def test_a_node_broadcasts_the_frames_that_its_parameters_say(name, settings, expected):
    assert frames(modelled(name, settings={"/**": settings})) == expected


@pytest.mark.parametrize(
    ("name", "settings", "expected"),
    [
        ("nav2_amcl/amcl", {}, ["base_footprint"]),
        ("nav2_amcl/amcl", {"base_frame_id": "b"}, ["b"]),
        ("nav2_planner/planner_server", {"robot_base_frame": "b"}, ["map", "b"]),
        ("nav2_planner/planner_server",
         {"obstacle_layer.observation_sources": "s", "obstacle_layer.s.sensor_frame": "/laser"},
         ["map", "base_link", "/laser"]),
        ("slam_toolbox/async_slam_toolbox_node", {}, ["base_footprint"]),
    ],
)  # fmt: skip
def test_a_node_looks_the_frames_up_that_its_parameters_say(name, settings, expected):
    uses = modelled(name, settings={"/**": settings}).frame_uses
    assert [use.frame for use in uses] == expected
    assert all(use.is_look_up for use in uses)


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        ("0 0 -1 0 0 0 a b", [("b", "a")]),
        ("0 0 -1 0 0 0 1 a b --ros-args -r c:=d", [("b", "a")]),
        ("--frame-id a --x -1 --child-frame-id b", [("b", "a")]),
        ("0 0 0 a b", []),
        ("", []),
    ],
)
def test_a_fixed_transform_is_that_of_the_arguments(args, expected):
    found = modelled("tf2_ros/static_transform_publisher", args=args)
    assert frames(found) == expected
    assert all(frame.is_fixed for frame in found.frames)


def test_a_component_s_fixed_transform_is_that_of_its_parameters():
    settings = {"/**": {"frame_id": "a", "child_frame_id": "b"}}
    assert frames(modelled("tf2_ros/static_transform_publisher", settings=settings)) == [("b", "a")]


@pytest.mark.parametrize(
    ("name", "settings", "expected"),
    [
        ("/base", {}, [("base_link", "odom")]),
        ("/r/base", {}, [("r/base_link", "r/odom")]),
        ("/r/base", {"tf_frame_prefix_enable": False}, [("base_link", "odom")]),
        ("/r/base", {"tf_frame_prefix": "~/x"}, [("r/x/base_link", "r/x/odom")]),
        ("/base", {"enable_odom_tf": False}, []),
        ("/base", {"base_frame_id": "b", "odom_frame_id": "o"}, [("b", "o")]),
    ],
)
def test_a_differential_drive_prefixes_its_frames(name, settings, expected):
    at = ros2_node_site(name=name, settings={"/**": settings})
    model = MODELS.controller("diff_drive_controller/DiffDriveController")
    assert frames(node_interface(model, at, models=MODELS)) == expected
