"""Every model of the library can be read, evaluated and followed to its source."""

import re

import pytest
from model_cases import URDF, frames, names, parameters, site, told

from rtron.sources.models import PluginElement, controller_interface, load_models, node_interface
from rtron.sources.models import plugin_interface as plugin_at
from rtron.vocabulary import UnknownValue

MODELS = load_models()
TYPE = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*")

NODES = """
amcl/amcl apriltag_ros/apriltag_ros_continuous_node
apriltag_ros/apriltag_ros_single_image_server_node ar_track_alvar/findMarkerBundles
ar_track_alvar/findMarkerBundlesNoKinect ar_track_alvar/individualMarkers
ar_track_alvar/individualMarkersNoKinect aruco_ros/double aruco_ros/marker_publisher
aruco_ros/single audio_capture/audio_capture audio_play/audio_play
cartographer_ros/cartographer_node cartographer_ros/cartographer_occupancy_grid_node
controller_manager/spawner cv_camera/cv_camera_node darknet_ros/darknet_ros
depthimage_to_laserscan/depthimage_to_laserscan diagnostic_aggregator/aggregator_node
explore_lite/explore fetch_teleop/joystick_teleop find_object_2d/find_object_2d
foxglove_bridge/foxglove_bridge gazebo_ros/gzclient gazebo_ros/gzserver gazebo_ros/spawn_model
gmapping/slam_gmapping grid_map_visualization/grid_map_visualization gscam/gscam
hector_mapping/hector_mapping hls_lfcd_lds_driver/hlds_laser_publisher image_proc/image_proc
image_transport/republish imu_complementary_filter/complementary_filter_node
imu_filter_madgwick/imu_filter imu_filter_madgwick/imu_filter_node
ira_laser_tools/laserscan_multi_merger ira_laser_tools/laserscan_virtualizer
joint_state_publisher/joint_state_publisher joy/joy_node joy_teleop/joy_teleop
joy_teleop/joy_teleop.py key_teleop/key_teleop key_teleop/key_teleop.py
laser_scan_matcher/laser_scan_matcher_node livox_ros_driver2/livox_ros_driver2_node
lms1xx/LMS1xx_node map_server/map_server mavros/gcs_bridge mavros/mavros_node
mbf_costmap_nav/mbf_costmap_nav mbf_simple_nav/mbf_simple_nav mouse_teleop/mouse_teleop
mouse_teleop/mouse_teleop.py move_base/move_base moveit_ros_move_group/move_group
moveit_servo/servo_server multirobot_map_merge/map_merge nmea_navsat_driver/nmea_serial_driver
nmea_navsat_driver/nmea_socket_driver nmea_navsat_driver/nmea_topic_driver
nmea_navsat_driver/nmea_topic_serial_reader nodelet/nodelet
octomap_server/color_octomap_server_node octomap_server/octomap_server_node
pcl_ros/pcd_to_pointcloud pid/controller raspicam_node/raspicam_node
rf2o_laser_odometry/rf2o_laser_odometry_node robot_localization/ekf_localization_node
robot_pose_ekf/robot_pose_ekf robot_pose_publisher/robot_pose_publisher
robot_state_publisher/robot_state_publisher ros_tcp_endpoint/default_server_endpoint.py
rosapi/rosapi_node rosbag/play rosbag/record rosbridge_server/rosbridge_websocket
roscpp_tutorials/listener roscpp_tutorials/talker rospy_tutorials/listener
rospy_tutorials/listener.py rospy_tutorials/talker rospy_tutorials/talker.py
rosserial_python/serial_node.py rosserial_server/serial_node rosserial_server/socket_node
rosserial_server/udp_socket_node rostopic/rostopic rplidar_ros/rplidarNode
rslidar_sdk/rslidar_sdk_node rtabmap_odom/icp_odometry rtabmap_odom/rgbd_odometry
rtabmap_odom/stereo_odometry rtabmap_ros/icp_odometry rtabmap_ros/rgbd_odometry
rtabmap_ros/rgbd_sync rtabmap_ros/rtabmap rtabmap_ros/rtabmapviz rtabmap_ros/stereo_odometry
rtabmap_ros/stereo_sync rtabmap_slam/rtabmap rtabmap_sync/rgbd_sync rtabmap_sync/stereo_sync
rtabmap_viz/rtabmap_viz rviz/rviz sbg_driver/sbg_device
sick_safetyscanners/sick_safetyscanners_node sick_scan_xd/sick_generic_caller sick_tim/sick_tim310
sick_tim/sick_tim310_1130000m01 sick_tim/sick_tim310s01 sick_tim/sick_tim551_2050001
slam_toolbox/async_slam_toolbox_node slam_toolbox/lifelong_slam_toolbox_node
slam_toolbox/localization_slam_toolbox_node slam_toolbox/sync_slam_toolbox_node
sound_play/soundplay_node.py spacenav_node/spacenav_node stage_ros/stageros
stereo_image_proc/stereo_image_proc teleop_twist_keyboard/teleop_twist_keyboard.py
tf/static_transform_publisher tf2_ros/static_transform_publisher
tf2_web_republisher/tf2_web_republisher topic_tools/mux topic_tools/relay
turtlebot3_teleop/turtlebot3_teleop_key turtlebot_teleop/turtlebot_teleop_key turtlesim/draw_square
turtlesim/mimic turtlesim/turtle_teleop_key turtlesim/turtlesim_node twist_mux/joystick_relay
twist_mux/joystick_relay.py twist_mux/twist_mux ublox_gps/ublox_gps urg_node/urg_node
usb_cam/usb_cam_node velodyne_driver/velodyne_node vesc_ackermann/ackermann_to_vesc_node
vesc_ackermann/vesc_to_odom_node vesc_driver/vesc_driver_node video_stream_opencv/video_stream
web_video_server/web_video_server wiimote/teleop_wiimote wiimote/wiimote_node
ydlidar_ros_driver/ydlidar_ros_driver_node
"""
NODELETS = """
apriltag_ros/ContinuousDetector cv_camera/CvCameraNodelet depth_image_proc/convert_metric
depth_image_proc/disparity depth_image_proc/point_cloud_xyz depth_image_proc/point_cloud_xyzrgb
depth_image_proc/register foxglove_bridge/foxglove_bridge_nodelet gscam/GSCamNodelet
image_proc/crop_decimate image_proc/debayer image_proc/rectify image_proc/resize
imu_complementary_filter/ComplementaryFilterNodelet imu_filter_madgwick/ImuFilterNodelet
kobuki_node/KobukiNodelet kobuki_safety_controller/SafetyControllerNodelet
laser_scan_matcher/LaserScanMatcherNodelet octomap_color_server/OctomapServerNodelet
octomap_server/OctomapServerNodelet openni2_camera/OpenNI2DriverNodelet pcl/CropBox
pcl/EuclideanClusterExtraction pcl/ExtractIndices pcl/PassThrough
pcl/PointCloudConcatenateDataSynchronizer pcl/ProjectInliers pcl/RadiusOutlierRemoval
pcl/SACSegmentation pcl/StatisticalOutlierRemoval pcl/VoxelGrid
phidgets_spatial/PhidgetsSpatialNodelet pointgrey_camera_driver/PointGreyCameraNodelet
rtabmap_odom/icp_odometry rtabmap_odom/rgbd_odometry rtabmap_odom/stereo_odometry
rtabmap_ros/icp_odometry rtabmap_ros/rgbd_odometry rtabmap_ros/rgbd_sync rtabmap_ros/rtabmap
rtabmap_ros/stereo_odometry rtabmap_ros/stereo_sync rtabmap_slam/rtabmap rtabmap_sync/rgbd_sync
rtabmap_sync/stereo_sync video_stream_opencv/VideoStream yocs_cmd_vel_mux/CmdVelMuxNodelet
yocs_velocity_smoother/VelocitySmootherNodelet
"""


def test_the_library_has_the_nodes_and_nodelets():
    assert [name for name in NODES.split() if MODELS.node(*name.split("/")) is None] == []
    assert [name for name in NODELETS.split() if MODELS.nodelet(name) is None] == []


@pytest.mark.parametrize(
    "filename",
    [
        "libgazebo_ros_p3d.so",
        "libhector_gazebo_ros_imu.so",
        "libgazebo_ros_multicamera.so",
        "libgazebo_ros_laser.so",
        "libgazebo_ros_diff_drive.so",
        "gazebo_ros_imu",
        "/opt/ros/melodic/lib/libgazebo_ros_control.so",
        "libhector_gazebo_ros_gps.so",
        "libgazebo_ros_camera.so",
        "libgazebo_ros_openni_kinect.so",
        "libfetch_gazebo_plugin.so",
        "libgazebo_ros_kobuki.so",
    ],
)
def test_the_library_has_the_gazebo_plugin(filename):
    assert MODELS.gazebo_plugin(filename) is not None


@pytest.mark.parametrize("layer", ["Static", "Inflation", "Obstacle", "Voxel", "FetchDepth"])
def test_the_library_has_the_costmap_layer(layer):
    assert ("costmap_layer", f"costmap_2d::{layer}Layer") in MODELS.by_name


@pytest.mark.parametrize("key", sorted(k for k in MODELS.by_name if k[0] == "node"), ids="/".join)
def test_every_node_is_evaluated_without_parameters(key):
    found = node_interface(MODELS.by_name[key], site(name="/ns/node"))
    for declaration in found.declarations:
        assert declaration.name.startswith("/")
        assert "//" not in declaration.name
        assert declaration.type == "" or TYPE.fullmatch(declaration.type), declaration
        assert declaration.type.endswith("Action") is declaration.kind.startswith("action")
        assert all(e.file.startswith("github.com/") for e in declaration.evidence)


def test_every_explicit_endpoint_names_a_line():
    for key, model in MODELS.by_name.items():
        for entry in model.walk():
            assert entry.kind is None or entry.line or ":" in entry.at, key


def test_costmap_layers_of_before_hydro():
    values = {
        "/move_base/global_costmap/static_map": True,
        "/move_base/global_costmap/map_topic": "/other_map",
        "/move_base/local_costmap/observation_sources": "scan",
        "/move_base/local_costmap/scan": {"data_type": "LaserScan", "topic": "/laser"},
    }
    found = node_interface(
        MODELS.node("move_base", "move_base"), site(name="/move_base", values=values)
    )
    assert ("subscribe", "/other_map", "nav_msgs/OccupancyGrid") in told(found)
    assert ("subscribe", "/laser", "sensor_msgs/LaserScan") in told(found)
    layers = {name.split("/")[3] for name in names(found, "publish") if "layer/" in name}
    assert layers == {"static_layer", "obstacle_layer", "inflation_layer"}


@pytest.mark.parametrize(
    ("node", "release", "expected"),
    [
        ("move_base/move_base", "kinetic", {"base", "laser"}),
        ("move_base/move_base", "melodic", {"/base", "/laser"}),
        ("amcl/amcl", "noetic", {"base"}),
        ("gmapping/slam_gmapping", "noetic", {"base"}),
    ],
)
def test_tf_leaves_out_a_slash_before_a_frame_and_tf2_does_not(node, release, expected):
    values = {
        "/n/base_frame": "/base",
        "/n/base_frame_id": "/base",
        "/n/local_costmap/robot_base_frame": "/base",
        "/n/local_costmap/observation_sources": "scan",
        "/n/local_costmap/scan": {"sensor_frame": "/laser"},
    }
    at = site("/n", values, environ=[("ROS_DISTRO", release)])
    found = node_interface(MODELS.node(*node.split("/")), at)
    assert {use.frame for use in found.frame_uses} - {"map", "base_link"} == expected


def test_move_base_flex_with_its_plugins():
    values = {
        "/nav/planners": [{"name": "Global", "type": "global_planner/GlobalPlanner"}],
        "/nav/controllers": [{"name": "Teb", "type": "teb_local_planner/TebLocalPlannerROS"}],
        "/nav/Teb/odom_topic": "/odom/filtered",
    }
    found = node_interface(
        MODELS.node("mbf_costmap_nav", "mbf_costmap_nav"), site(name="/nav", values=values)
    )
    assert {"/cmd_vel", "/nav/Global/plan", "/nav/Teb/local_plan"} <= names(found, "publish")
    assert {"/nav/Teb/via_points", "/odom/filtered"} <= names(found, "subscribe")
    assert "/nav/local_costmap/costmap" in names(found, "publish")
    assert ("action_client", "/nav/exe_path", "mbf_msgs/ExePathAction") in told(found)
    assert ("action_server", "/nav/get_path", "mbf_msgs/GetPathAction") in told(found)


def test_with_plugins_a_layer_reads_only_its_own_parameters():
    plugins = [{"name": "obstacles", "type": "costmap_2d::ObstacleLayer"}]
    values = {
        "/move_base/local_costmap/plugins": plugins,
        "/move_base/local_costmap/observation_sources": "scan",
    }
    found = node_interface(
        MODELS.node("move_base", "move_base"), site(name="/move_base", values=values)
    )
    assert "/scan" not in names(found, "subscribe")


def test_an_unknown_layer_type_is_unresolved():
    plugins = [{"name": "people", "type": "social_navigation_layers::ProxemicLayer"}]
    values = {"/move_base/local_costmap/plugins": plugins}
    found = node_interface(
        MODELS.node("move_base", "move_base"), site(name="/move_base", values=values)
    )
    assert "costmap_layer:social_navigation_layers::ProxemicLayer" in {
        u.what for u in found.unresolved
    }


def test_twist_mux_as_its_parameters_say():
    values = {
        "/twist_mux/topics": [
            {"name": "joy", "topic": "joy_teleop/cmd_vel", "priority": 10},
            {"name": "nav", "topic": "/cmd_vel_nav", "priority": 1},
        ],
        "/twist_mux/locks": [{"name": "stop", "topic": "e_stop", "priority": 255}],
    }
    found = node_interface(
        MODELS.node("twist_mux", "twist_mux"), site(name="/twist_mux", values=values)
    )
    assert told(found) == {
        ("publish", "/cmd_vel_out", "geometry_msgs/Twist"),
        ("publish", "/diagnostics", "diagnostic_msgs/DiagnosticArray"),
        ("subscribe", "/joy_teleop/cmd_vel", "geometry_msgs/Twist"),
        ("subscribe", "/cmd_vel_nav", "geometry_msgs/Twist"),
        ("subscribe", "/e_stop", "std_msgs/Bool"),
    }


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        ("pub /goal geometry_msgs/Pose x", ("publish", "/goal", "geometry_msgs/Pose")),
        ("pub -r 10 goal std_msgs/Empty", ("publish", "/ns/goal", "std_msgs/Empty")),
        ("pub -1 /goal std_msgs/Empty", ("publish", "/goal", "std_msgs/Empty")),
        ("echo /odom", ("subscribe", "/odom", "")),
    ],
)
def test_rostopic(args, expected):
    found = node_interface(MODELS.node("rostopic", "rostopic"), site(name="/ns/pub", args=args))
    assert told(found) == {expected}


@pytest.mark.parametrize(
    ("args", "subscribed", "unresolved"),
    [
        ("-O /tmp/x /odom scan", {"/odom", "/ns/scan"}, 0),
        ("-a", set(), 1),
        ("-e /camera.*", set(), 1),
    ],
)
def test_rosbag_record(args, subscribed, unresolved):
    found = node_interface(MODELS.node("rosbag", "record"), site(name="/ns/record", args=args))
    assert names(found, "subscribe") == subscribed
    assert len(found.unresolved) == unresolved


@pytest.mark.parametrize(
    ("executable", "args", "subscribed", "published"),
    [
        ("relay", "/a b", "/a", "/ns/b"),
        ("relay", "/a", "/a", "/a_relay"),
        ("throttle", "messages /a 10 /b", "/a", "/b"),
        ("throttle", "messages /a 10", "/a", "/a_throttle"),
        ("throttle", "bytes /a 1000 2 /b", "/a", "/b"),
        ("drop", "/a 1 2", "/a", "/a_drop"),
        ("mux", "/out /a", "/a", "/out"),
        ("demux", "/a /out", "/a", "/out"),
    ],
)
def test_topic_tools(executable, args, subscribed, published):
    found = node_interface(MODELS.node("topic_tools", executable), site(name="/ns/tool", args=args))
    assert names(found, "subscribe") == {subscribed}
    assert names(found, "publish") - {"/ns/mux/selected", "/ns/demux/selected"} == {published}


def test_rosserial_and_rosbridge_say_what_they_cannot_know():
    for name in ("rosserial_python/serial_node.py", "rosbridge_server/rosbridge_websocket"):
        assert node_interface(MODELS.node(*name.split("/")), site()).unresolved
        assert MODELS.node(*name.split("/")).unread


def test_image_transport_of_a_subscriber():
    model = MODELS.nodelet("image_proc/debayer")
    values = {"/camera/debayer/image_transport": "compressed"}
    found = node_interface(model, site(name="/camera/debayer", values=values))
    assert ("subscribe", "/camera/image_raw/compressed", "sensor_msgs/CompressedImage") in told(
        found
    )
    assert "/camera/image_raw" not in names(found, "subscribe")


def test_disabled_image_transports():
    values = {"/cam/image_raw/disable_pub_plugins": ["image_transport/theora"]}
    found = node_interface(MODELS.node("usb_cam", "usb_cam_node"), site(name="/cam", values=values))
    published = names(found, "publish")
    assert "/cam/image_raw/compressed" in published
    assert "/cam/image_raw/theora" not in published
    assert "/cam/camera_info" in published


def plugin_names(filename, **element):
    plugin = PluginElement(filename=filename, **element)
    found = plugin_at(MODELS.gazebo_plugin(filename), site(name="/gazebo"), plugin)
    return names(found, "publish") | names(found, "subscribe")


@pytest.mark.parametrize(
    ("values", "more", "expected"),
    [
        ({}, {}, "/cmd_vel"),
        ({"robotNamespace": "husky"}, {}, "/husky/cmd_vel"),
        ({"robotNamespace": ""}, {"model_name": "bob"}, "/bob/cmd_vel"),
        ({}, {"robot_namespace": "", "model_name": "bob"}, "/bob/cmd_vel"),
        ({}, {"robot_namespace": ""}, "/{model}/cmd_vel"),
        ({"commandTopic": "/go"}, {}, "/go"),
    ],
)
def test_the_namespace_of_a_gazebo_plugin(values, more, expected):
    assert expected in plugin_names("libgazebo_ros_diff_drive.so", values=values, **more)


@pytest.mark.parametrize(
    ("cameras", "sides"),
    [
        ((), {"left", "right"}),
        (("left",), {"left"}),
        (("left_eye", "right_eye"), {"left", "right"}),
    ],
)
def test_a_multicamera_has_a_camera_a_side(cameras, sides):
    found = plugin_names(
        "libgazebo_ros_multicamera.so", values={"cameraName": "eyes"}, cameras=cameras
    )
    assert {n.split("/")[2] for n in found if n.endswith("/image_raw")} == sides


def test_a_controller_lives_below_the_spawners_namespace():
    types = parameters(
        {
            "/arm/traj/type": "position_controllers/JointTrajectoryController",
            "/arm/js/type": "joint_state_controller/JointStateController",
            "/arm/odd/type": "my/Controller",
            "/arm/late/type": UnknownValue("why"),
        }
    )
    spawner = site(name="/arm/spawner", args="--stopped --timeout 10 traj js odd late gone")
    found = controller_interface(spawner, types)
    assert told(found) == {
        ("subscribe", "/arm/traj/command", "trajectory_msgs/JointTrajectory"),
        ("publish", "/arm/traj/state", "control_msgs/JointTrajectoryControllerState"),
        (
            "action_server",
            "/arm/traj/follow_joint_trajectory",
            "control_msgs/FollowJointTrajectoryAction",
        ),
        ("service", "/arm/traj/query_state", "control_msgs/QueryTrajectoryState"),
        ("publish", "/arm/joint_states", "sensor_msgs/JointState"),
    }
    assert [(u.what, u.why) for u in found.unresolved] == [
        ("controller /arm/odd", "no model of my/Controller"),
        ("controller /arm/late", "its type is not known"),
        ("controller /arm/gone", "its parameter type is not set"),
    ]


@pytest.mark.parametrize("args", ["spawn js", "--namespace=/arm js", "--namespace /arm js"])
def test_ways_to_load_a_controller(args):
    types = parameters({"/arm/js/type": "joint_state_controller/JointStateController"})
    found = controller_interface(site(name="/arm/x", args=args), types)
    assert names(found, "publish") == {"/arm/joint_states"}


RVIZ = """
Visualization Manager:
  Displays:
  - {Class: rviz/LaserScan, Enabled: true, Topic: /scan}
  - {Class: rviz/Image, Enabled: false, Image Topic: /off}
  - Class: rviz/Group
    Enabled: true
    Displays:
    - {Class: rviz/Map, Enabled: true, Topic: /map}
    - {Class: rviz/Image, Enabled: true, Image Topic: /camera/image}
  - {Class: rviz/Group, Enabled: false, Displays: [{Class: rviz/Path, Topic: /hidden}]}
  - {Class: rviz/Grid, Enabled: true}
  Tools:
  - {Class: rviz/MoveCamera}
  - {Class: rviz/SetGoal, Topic: goal}
  - {Class: rviz/SetInitialPose}
"""


def test_rviz_as_its_configuration_says(tmp_path):
    (tmp_path / "my.rviz").write_text(RVIZ, encoding="utf-8")
    found = node_interface(
        MODELS.node("rviz", "rviz"), site(name="/rviz", args=f"-d {tmp_path}/my.rviz")
    )
    explicit = {(str(d.kind), d.name) for d in found.declarations if not d.implicit}
    assert explicit == {
        ("subscribe", "/scan"),
        ("subscribe", "/map"),
        ("subscribe", "/map_updates"),
        ("subscribe", "/camera/image"),
        ("publish", "/goal"),
        ("publish", "/initialpose"),
        ("service", "/rviz/reload_shaders"),
        ("service", "/rviz/load_config"),
        ("service", "/rviz/load_config_discarding_changes"),
        ("service", "/rviz/save_config"),
    }


@pytest.mark.parametrize(
    ("display", "prefix"),
    [("Move Group Namespace: ''", "/"), ("Move Group Namespace: arm", "/arm/"),
     ("Enabled: true", "/"), ("Enabled: false", None)],
)  # fmt: skip
def test_the_panel_of_moveit_sends_goals(tmp_path, display, prefix):
    text = f"{{Class: moveit_rviz_plugin/MotionPlanning, {display}}}"
    (tmp_path / "my.rviz").write_text(f"Visualization Manager: {{Displays: [{text}]}}")
    args = f"-d {tmp_path}/my.rviz"
    found = node_interface(MODELS.node("rviz", "rviz"), site(name="/rviz", args=args))
    actions = ("move_group", "execute_trajectory") if prefix else ()
    assert names(found, "action_client") == {f"{prefix}{name}" for name in actions}


@pytest.mark.parametrize("text", ["[1, 2]", "a: &x 1", "{", "Visualization Manager: 3", ""])
def test_rviz_survives_any_configuration(tmp_path, text):
    (tmp_path / "my.rviz").write_text(text, encoding="utf-8")
    found = node_interface(
        MODELS.node("rviz", "rviz"), site(name="/rviz", args=f"-d {tmp_path}/my.rviz")
    )
    assert "/tf" in names(found, "subscribe")


@pytest.mark.parametrize("path", ["/nonexistent/mux.yaml", "/dev/zero", "/"])
def test_a_yaml_file_that_cannot_be_read_leaves_holes(path):
    model = MODELS.nodelet("yocs_cmd_vel_mux/CmdVelMuxNodelet")
    found = node_interface(model, site(name="/mux", values={"/mux/yaml_cfg_file": path}))
    assert any("{" in name for name in names(found, "subscribe"))
    assert any("{" in name for name in names(found, "publish"))


@pytest.mark.parametrize(
    ("name", "at", "expected"),
    [
        ("tf/static_transform_publisher", {"args": "0 0 -1 0 0 0 a b 9"}, [("b", "a")]),
        ("tf/static_transform_publisher", {"args": "0 0 -1 0 0 0 1 a b 9"}, [("b", "a")]),
        ("tf/static_transform_publisher", {"args": "0 0 -1 0 0 0 a b"}, []),
        ("tf2_ros/static_transform_publisher", {"args": "0 0 -1 0 0 0 a b x:=y"}, [("b", "a")]),
        ("tf2_ros/static_transform_publisher", {"args": "/parameters"}, []),
        ("amcl/amcl", {}, [("odom", "map")]),
        ("amcl/amcl", {"values": {"/robot/driver/tf_broadcast": False}}, []),
        ("gmapping/slam_gmapping", {}, [("odom", "map")]),
        ("gmapping/slam_gmapping", {"values": {"/robot/driver/transform_publish_period": 0}}, []),
        ("fake_localization/fake_localization", {}, [("odom", "map")]),
        ("hector_mapping/hector_mapping", {}, [("odom", "map"), ("scanmatcher_frame", "map")]),
        ("robot_pose_ekf/robot_pose_ekf", {}, [("base_footprint", "odom_combined")]),
        ("robot_localization/ekf_localization_node", {}, [("base_link", "odom")]),
        ("robot_localization/ekf_localization_node",
         {"values": {"/robot/driver/world_frame": "map", "/tf_prefix": "/r"}},
         [("r/odom", "r/map")]),
        ("robot_localization/ukf_localization_node",
         {"values": {"/robot/driver/publish_tf": False}}, []),
        ("robot_state_publisher/robot_state_publisher", {"values": {"/robot_description": URDF}},
         [("laser", "base"), ("arm", "base")]),
        (
            "robot_state_publisher/robot_state_publisher",
            {
                "values": {"/robot_description": URDF.replace("base", "x"), "/other": URDF},
                "remaps": [("/robot/robot_description", "/other")],
            },
            [("laser", "base"), ("arm", "base")],
        ),
        ("robot_state_publisher/robot_state_publisher", {"values": {"/robot_description": "<"}},
         []),
        ("robot_state_publisher/robot_state_publisher", {}, []),
    ],
)  # fmt: skip
def test_a_node_broadcasts_the_frames_that_the_launch_says(name, at, expected):
    assert frames(node_interface(MODELS.node(*name.split("/")), site(**at))) == expected


def test_an_unknown_switch_leaves_a_frame_and_an_unknown_name_is_empty():
    values = {"/robot/driver/publish_tf": UnknownValue("at run time")}
    model = MODELS.node("robot_localization", "ekf_localization_node")
    found = node_interface(model, site(values=values))
    assert [(frame.child, frame.is_certain) for frame in found.frames] == [("base_link", False)]
    values = {"/robot/driver/world_frame": UnknownValue("at run time")}
    assert frames(node_interface(model, site(values=values))) == [("", "")]


def test_controllers_of_ros1_broadcast_frames():
    values = {"/base/type": "diff_drive_controller/DiffDriveController", "/base/odom_frame_id": "o"}
    spawner = site(name="/spawner", values=values, args="base")
    assert frames(controller_interface(spawner, spawner.parameters)) == [("base_link", "o")]


@pytest.mark.parametrize(
    ("filename", "values", "expected"),
    [
        ("libgazebo_ros_diff_drive.so", {}, [("base_footprint", "odom")]),
        ("libgazebo_ros_diff_drive.so", {"publishOdomTF": "false"}, []),
        ("libgazebo_ros_diff_drive.so", {"robotBaseFrame": "b"}, [("b", "odom")]),
        ("libgazebo_ros_skid_steer_drive.so", {}, []),
        ("libgazebo_ros_skid_steer_drive.so", {"broadcastTF": "1"}, [("base_footprint", "odom")]),
        ("libgazebo_ros_planar_move.so", {}, [("base_footprint", "odom")]),
    ],
)
def test_a_plugin_broadcasts_the_frames_of_its_element(filename, values, expected):
    plugin = PluginElement(filename=filename, values=values)
    found = plugin_at(MODELS.gazebo_plugin(filename), site(name="/gazebo"), plugin)
    assert frames(found) == expected


def test_a_pid_controller_is_wired_by_its_parameters():
    values = {"/x/topic_from_controller": "/force/x", "/x/setpoint_topic": "x/setpoint"}
    found = node_interface(MODELS.node("pid", "controller"), site(name="/x", values=values))
    assert {"/force/x", "/pid_debug"} <= names(found, "publish")
    assert names(found, "subscribe") == {"/state", "/x/setpoint", "/pid_enable"}


def test_an_inertial_sensor_publishes_the_logs_that_are_on():
    logs = {"log_imu_data": 8, "log_ekf_quat": 8, "log_mag": 0}
    values = {f"/sbg/output/{name}": value for name, value in logs.items()}
    model = MODELS.node("sbg_driver", "sbg_device")
    standard = {"/sbg/output/ros_standard": True, "/sbg/output/use_enu": True}
    topics = {
        name: names(node_interface(model, site(name="/sbg", values=given)), "publish")
        for name, given in {"own": values, "standard": {**values, **standard}}.items()
    }
    assert topics["own"] == {"/sbg/imu_data", "/sbg/ekf_quat", "/tf", "/tf_static"}
    assert topics["standard"] - topics["own"] == {"/imu/data", "/imu/temp"}


def test_a_grid_map_is_shown_by_what_its_list_says():
    shown = [{"name": "cloud", "type": "point_cloud"}, {"name": "edge", "type": "map_region"}]
    values = {"/show/grid_map_visualizations": shown, "/show/grid_map_topic": "/map/grid"}
    model = MODELS.node("grid_map_visualization", "grid_map_visualization")
    assert told(node_interface(model, site(name="/show", values=values))) == {
        ("publish", "/show/cloud", "sensor_msgs/PointCloud2"),
        ("publish", "/show/edge", "visualization_msgs/Marker"),
        ("subscribe", "/map/grid", "grid_map_msgs/GridMap"),
    }
