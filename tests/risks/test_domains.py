"""What a topic is for: the table must place topics of apps that nobody had in mind."""

import pytest

from rtron.risks import default_lists
from rtron.risks.topic_table import NamePatterns, TopicTable, TopicTableEntry
from rtron.vocabulary import normalise_type

PERCEPTION = {
    "/scan": "sensor_msgs/LaserScan",
    "/points_raw": "sensor_msgs/PointCloud2",
    "/imu/data": "sensor_msgs/msg/Imu",
    "/odometry/filtered": "nav_msgs/Odometry",
    "/diff_drive_controller/odom": "nav_msgs/Odometry",
    "/tf": "tf2_msgs/TFMessage",
    "/map": "nav_msgs/OccupancyGrid",
    "/amcl_pose": "geometry_msgs/PoseWithCovarianceStamped",
    "/initialpose": "geometry_msgs/PoseWithCovarianceStamped",
    "/mavros/local_position/pose": "geometry_msgs/PoseStamped",
    "/mavros/state": "mavros_msgs/State",
    "/joint_states": "sensor_msgs/JointState",
    "/move_base/status": "actionlib_msgs/GoalStatusArray",
    "/move_base/feedback": "move_base_msgs/MoveBaseActionFeedback",
    "/navigate_to_pose/_action/status": "action_msgs/msg/GoalStatusArray",
    "/arm/_action/feedback": "control_msgs/action/FollowJointTrajectory_FeedbackMessage",
    "/detect/lane": "std_msgs/Float64",
    "/perception/object_recognition/objects": "autoware_perception_msgs/msg/PredictedObjects",
    "/detection/lidar_detector/objects": "autoware_msgs/DetectedObjectArray",
    "/apollo/perception/obstacles": "pb_msgs/PerceptionObstacles",
    "/battery_level": "std_msgs/Float32",
    "/local_costmap/costmap": "nav2_msgs/msg/Costmap",
    "/tag_detections": "apriltag_ros/AprilTagDetectionArray",
}
PLANNING = {
    "/move_base_simple/goal": "geometry_msgs/PoseStamped",
    "/goal_pose": "geometry_msgs/msg/PoseStamped",
    "/move_base/goal": "move_base_msgs/MoveBaseActionGoal",
    "/move_base/cancel": "actionlib_msgs/GoalID",
    "/plan": "nav_msgs/msg/Path",
    "/waypoints": "std_msgs/String",
    "/mavros/mission/waypoints": "mavros_msgs/WaypointList",
    "/planning/scenario_planning/trajectory": "autoware_planning_msgs/msg/Trajectory",
    "/final_waypoints": "autoware_msgs/Lane",
    "/apollo/planning": "pb_msgs/ADCTrajectory",
    "/core/decided_mode": "std_msgs/UInt8",
    "/behavior_state": "std_msgs/String",
    "/lane_graph": "my_msgs/GlobalRoute",
}
CONTROL = {
    "/cmd_vel": "geometry_msgs/Twist",
    "/cmd_vel_nav": "geometry_msgs/msg/TwistStamped",
    "/control/max_vel": "std_msgs/Float64",
    "/ackermann_cmd": "ackermann_msgs/AckermannDriveStamped",
    "/arm_controller/command": "trajectory_msgs/JointTrajectory",
    "/arm/follow_joint_trajectory/goal": "control_msgs/FollowJointTrajectoryActionGoal",
    "/arm/follow_joint_trajectory/cancel": "actionlib_msgs/GoalID",
    "/gripper/position_command": "std_msgs/Float64",
    "/rosbot_audio/audio": "audio_common_msgs/AudioData",
    "/robotsound": "sound_play/SoundRequest",
    "/joy": "sensor_msgs/Joy",
    "/mavros/setpoint_position/local": "geometry_msgs/PoseStamped",
    "/mavros/setpoint_raw/attitude": "mavros_msgs/AttitudeTarget",
    "/vehicle_cmd": "autoware_msgs/VehicleCmd",
    "/control/command/control_cmd": "autoware_control_msgs/msg/Control",
    "/joint_commands": "sensor_msgs/JointState",
    "/throttle": "std_msgs/Float32",
    "/apollo/control": "pb_msgs/ControlCommand",
    "/to_vehicle": "my_msgs/VehicleCmd",
}
STOPS = {"/base/estop": "std_msgs/Bool", "/status/estop_request": "std_msgs/Bool"}
STOP_STATES = {
    "/status/estop": "spot_msgs/EStopStateArray",
    "/estop_channel": "x_msgs/EStopStatus",
    "/base/status/emergency_stop": "std_msgs/Bool",
    "/e_stop_state": "std_msgs/Bool",
}
OTHERS = {
    "/rosout": "rosgraph_msgs/Log",
    "/diagnostics": "diagnostic_msgs/DiagnosticArray",
    "/x/parameter_updates": "dynamic_reconfigure/Config",
    "/object_markers": "visualization_msgs/MarkerArray",
    "/chatter": "std_msgs/String",
    "": "",
}
TOPICS = [
    *((topic, kind, "Perception") for topic, kind in PERCEPTION.items()),
    *((topic, kind, "Planning") for topic, kind in PLANNING.items()),
    *((topic, kind, "Control") for topic, kind in CONTROL.items()),
    *((topic, kind, "Control") for topic, kind in STOPS.items()),
    *((topic, kind, "Perception") for topic, kind in STOP_STATES.items()),
    *((topic, kind, "Others") for topic, kind in OTHERS.items()),
]


def classify(topic: str, message_type: str):
    return default_lists().classify(normalise_type(message_type), topic)


@pytest.mark.parametrize(("topic", "message_type", "domain"), TOPICS)
def test_the_domain_of_a_topic(topic, message_type, domain):
    assert classify(topic, message_type).domain.value == domain


@pytest.mark.parametrize(
    ("topic", "message_type", "sharing"),
    [
        ("/tf", "tf2_msgs/TFMessage", "merge"),
        ("/robot1/tf_static", "tf2_msgs/msg/TFMessage", "merge"),
        ("/anything/status", "std_msgs/String", "merge"),
        ("/diagnostics", "diagnostic_msgs/DiagnosticArray", "merge"),
        ("/arm/joint_states", "sensor_msgs/JointState", "merge"),
        ("/joint_commands", "sensor_msgs/JointState", "contend"),
        ("/cmd_vel", "geometry_msgs/Twist", "contend"),
        ("/odom", "nav_msgs/Odometry", "contend"),
    ],
)
def test_whether_publishers_share_a_topic_or_take_turns(topic, message_type, sharing):
    assert classify(topic, message_type).sharing.value == sharing


@pytest.mark.parametrize(
    ("topic", "message_type", "kind"),
    [
        ("/cmd_vel", "geometry_msgs/msg/Twist", "command"),
        ("/control/max_vel", "std_msgs/Float64", "command"),
        ("/to_vehicle", "my_msgs/VehicleCmd", "command"),
        ("/wheel_cmd", "my_msgs/Wheels", "command"),
        ("/move_base/goal", "move_base_msgs/MoveBaseActionGoal", "action"),
        ("/move_base_simple/goal", "geometry_msgs/PoseStamped", "action"),
        ("/odom", "nav_msgs/Odometry", "state"),
        ("/control/finished", "std_msgs/UInt8", "state"),
    ],
)
def test_what_a_topic_carries(topic, message_type, kind):
    assert classify(topic, message_type).kind.value == kind


class TestTable:
    def test_the_first_entry_that_matches_decides(self):
        table = TopicTable(
            [
                TopicTableEntry(category="both", types=("a/B",), topics=("/x*",)),
                TopicTableEntry(category="type", types=("a/*",)),
                TopicTableEntry(category="topic", topics=("*x*",)),
            ]
        )
        assert table.find("a/B", "/xy") == "both"
        assert table.find("a/B", "/y") == "type"
        assert table.find("b/C", "/xy") == "topic"
        assert table.find("b/C", "/y") is None

    @pytest.mark.parametrize(
        ("pattern", "text", "matches"),
        [
            ("/x", "/x", True),
            ("/x", "/x/y", False),
            ("/x*", "/x/y", True),
            ("*y", "/x/y", True),
            ("*y", "/y/x", False),
            ("*x*", "/y/x/z", True),
            ("/a*c", "/abc", True),
            ("/a*c", "/abd", False),
            ("/a*c", "x/abc", False),
            ("*a*c", "xaxc", True),
            ("a.c", "abc", False),
            ("*a.c*", "xabcx", False),
            ("*", "", True),
            ("*", "/any\nthing", True),
            ("", "", True),
            ("", "/x", False),
        ],
    )
    def test_a_pattern(self, pattern, text, matches):
        assert NamePatterns([pattern]).match(text) is matches

    def test_a_name_that_no_ros_has_costs_no_time(self):
        assert not NamePatterns(["*a*b"]).match("a" * 10**6 + "c")

    def test_no_pattern_matches_nothing(self):
        assert not NamePatterns([]).match("")
