"""What a topic, service or action moves, by type and name."""

import pytest

from rtron.findings.inventory.things import may_be_command, thing_of, vagueness
from rtron.vocabulary.inventory import Means, Thing

TWIST, FLOAT, BOOL = "geometry_msgs/msg/Twist", "std_msgs/msg/Float64", "std_msgs/msg/Bool"
TRIGGER = "std_srvs/srv/Trigger"
TOPIC, SERVICE, ACTION, _ = Means


@pytest.mark.parametrize(
    ("name", "type", "means", "thing"),
    [
        ("/cmd_vel", TWIST, TOPIC, Thing.BASE),
        ("/x/twist", "geometry_msgs/Twist", TOPIC, Thing.BASE),
        ("/mux/input/teleop", "ackermann_msgs/AckermannDriveStamped", TOPIC, Thing.BASE),
        ("/vesc/commands/motor/speed", FLOAT, TOPIC, Thing.BASE),
        ("/car_cmd", "duckietown_msgs/Twist2DStamped", TOPIC, Thing.BASE),
        ("/cmd_drive", "osr_interfaces/msg/CommandDrive", TOPIC, Thing.BASE),
        ("/out", "robot_msgs/msg/WheelSpeeds", TOPIC, Thing.BASE),
        ("/cmd_corner", "osr_interfaces/msg/CommandCorner", TOPIC, Thing.DEVICE),
        ("/a", "robot_msgs/msg/FlapCommand", TOPIC, Thing.DEVICE),
        ("/manual_control", "robot_msgs/msg/ManualControl", TOPIC, Thing.DEVICE),
        ("/manual_control", BOOL, TOPIC, Thing.MODE),
        ("/run_mission", "own/action/RunMission", ACTION, Thing.DEVICE),
        ("/cloud/action", "std_msgs/String", TOPIC, Thing.DEVICE),
        ("/arm_controller/joint_trajectory", "trajectory_msgs/JointTrajectory", TOPIC, Thing.ARM),
        ("/x", "control_msgs/action/FollowJointTrajectory", ACTION, Thing.ARM),
        ("/x", "control_msgs/action/GripperCommand", ACTION, Thing.GRIPPER),
        ("/claw/open", TRIGGER, SERVICE, Thing.GRIPPER),
        ("/ptz/cmd_vel", TWIST, TOPIC, Thing.BASE),
        ("/wrench", "geometry_msgs/Wrench", TOPIC, Thing.THRUSTERS),
        ("/thrusters/thrust", "sub_msgs/Thrust", TOPIC, Thing.THRUSTERS),
        ("/hardware_bridge/mower_control", "x/srv/MowerControl", SERVICE, Thing.TOOL),
        ("/set_valve", "x/SetValve", SERVICE, Thing.TOOL),
        ("/torpedo/fire", TRIGGER, SERVICE, Thing.TOOL),
        ("/horn", BOOL, TOPIC, Thing.HORN),
        ("/estop", BOOL, TOPIC, Thing.STOP),
        ("/my_emergency_thing", BOOL, TOPIC, Thing.STOP),
        ("/command/trajectory", "trajectory_msgs/MultiDOFJointTrajectory", TOPIC, Thing.VEHICLE),
        ("/left_wheel/cmd", FLOAT, TOPIC, Thing.BASE),
        ("/execute_path", TRIGGER, SERVICE, Thing.BASE),
        ("/robot/stop", "std_msgs/Int8", TOPIC, Thing.STOP),
        ("/arm_breaker", TRIGGER, SERVICE, Thing.POWER),
        (
            "/dxl/stop_controller",
            "dynamixel_controllers/StopController",
            SERVICE,
            Thing.CONTROLLERS,
        ),
        ("/clear_estop", TRIGGER, SERVICE, Thing.STOP),
        ("/set_relay_state", "std_srvs/SetBool", SERVICE, Thing.POWER),
        ("/runStop", "x/RunStop", TOPIC, Thing.STOP),
        ("/joystick/chassisCommand", "x/chassisCommand", TOPIC, Thing.BASE),
        ("/sub/arm", BOOL, TOPIC, Thing.ARMING),
        ("/servo_node/pause_servo", "std_srvs/srv/SetBool", SERVICE, Thing.ARM),
        (
            "/cm/set_hardware_component_state",
            "controller_manager_msgs/srv/SetHardwareComponentState",
            SERVICE,
            Thing.CONTROLLERS,
        ),
        ("/set_mobo_kill", TRIGGER, SERVICE, Thing.STOP),
        ("/create_cmd_vel", "geometry_msgs/Twist", TOPIC, Thing.BASE),
        ("/publish_goal", "move_base_msgs/MoveBaseAction", ACTION, Thing.BASE),
        ("/scan_arm", TRIGGER, SERVICE, Thing.ARM),
        ("/set_frame_velocity", TRIGGER, SERVICE, Thing.BASE),
        ("/set_velocity_in_frame", TRIGGER, SERVICE, Thing.BASE),
        ("/compute_and_move", TRIGGER, SERVICE, Thing.BASE),
        ("/drive_to_odom", TRIGGER, SERVICE, Thing.BASE),
        ("/calibrate_gripper", TRIGGER, SERVICE, Thing.GRIPPER),
        ("/gps_cmd_vel", TWIST, TOPIC, Thing.BASE),
        ("/rover/arm/cmd/goal_pos", "own/ArmMsg", TOPIC, Thing.ARM),
        ("/gripper/motor", FLOAT, TOPIC, Thing.GRIPPER),
        ("/robot/goal", "own/Goal", TOPIC, Thing.BASE),
        ("/a/shoulder_pan_cmd", "own/Servo", TOPIC, Thing.ARM),
        ("/a/shoulder_lift_cmd", "own/Servo", TOPIC, Thing.ARM),
        ("/aux/camera_pano", "own/Angle", TOPIC, Thing.HEAD),
        ("/pick_object", "own/action/PickObject", ACTION, Thing.ARM),
        ("/motion/PathPointsExec", "own/srv/GetPathPoints", SERVICE, Thing.BASE),
        ("/vibration_enable", BOOL, TOPIC, Thing.TOOL),
        (
            "/cm/cleanup",
            "controller_manager_msgs/srv/CleanupController",
            SERVICE,
            Thing.CONTROLLERS,
        ),
        ("/x/arm", TRIGGER, SERVICE, Thing.ARMING),
        ("/x/arm", FLOAT, TOPIC, Thing.ARM),
        ("/enable_motors", TRIGGER, SERVICE, Thing.ARMING),
        ("/mavros/cmd/arming", "mavros_msgs/srv/CommandBool", SERVICE, Thing.ARMING),
        ("/mavros/set_mode", "mavros_msgs/SetMode", SERVICE, Thing.MODE),
        ("/fsm/mode", "x/SetMode", SERVICE, Thing.MODE),
        ("/system/reboot", TRIGGER, SERVICE, Thing.POWER),
        ("/cm/switch", "controller_manager_msgs/srv/SwitchController", SERVICE, Thing.CONTROLLERS),
        ("/monitor/toggle", "nav2_msgs/srv/Toggle", SERVICE, Thing.CONTROLLERS),
        ("/speed_limit", "nav2_msgs/msg/SpeedLimit", TOPIC, Thing.LIMITS),
        ("/max_vel", FLOAT, TOPIC, Thing.LIMITS),
        ("/navigate_to_pose", "nav2_msgs/action/NavigateToPose", ACTION, Thing.BASE),
        ("/dock", "irobot_create_msgs/action/Dock", ACTION, Thing.BASE),
        ("/move_action", "moveit_msgs/action/MoveGroup", ACTION, Thing.ARM),
        ("/mavros/param/set", "mavros_msgs/srv/ParamSetV2", SERVICE, Thing.LIMITS),
    ],
)
def test_what_moves(name, type, means, thing):
    assert thing_of(name, type, means) is thing


@pytest.mark.parametrize(
    ("name", "type"),
    [
        ("/odom", "nav_msgs/Odometry"),
        ("/hmi/led/motors", "std_msgs/UInt8"),
        ("/lights/drive", BOOL),
        ("/motor/status", "x/Status"),
        ("/arm/joint_state", "x/State"),
        ("/cm/list_controllers", "controller_manager_msgs/srv/ListControllers"),
        ("/driver/get_speed", TRIGGER),
        ("/get_and_save_motor_state", TRIGGER),
        ("/cmd_vel_status", "x/Status"),
        ("/camera/image_color/compressed_throttle", ""),
        ("/move_base/clear_costmaps", "std_srvs/Empty"),
        ("/node/change_state", "lifecycle_msgs/srv/ChangeState"),
        ("/node/set_parameters", "rcl_interfaces/srv/SetParameters"),
        ("/nav/reload", "nav2_msgs/srv/ReloadDockDatabase"),
        ("/manager/unload_nodelet", "nodelet/NodeletUnload"),
        ("/rtcm", "rtcm_msgs/Message"),
        ("/drive/measured_twist", TWIST),
        ("/mavros/local_position/velocity_local", "geometry_msgs/TwistStamped"),
        ("/nav/planner_get_progress", TRIGGER),
        ("/coverage/plan_path", TRIGGER),
        ("/save_path", TRIGGER),
        ("/register_commands", TRIGGER),
        ("/set_mission_timer", TRIGGER),
        ("/mower_map_service/add_area", TRIGGER),
        ("/chatter", "std_msgs/String"),
        ("/plan_kinematic_path", "moveit_msgs/srv/GetMotionPlan"),
        ("/apply_planning_scene", "moveit_msgs/srv/ApplyPlanningScene"),
        ("/mavros/param/get", "mavros_msgs/ParamGet"),
        ("/joy_teleop/joy/set_feedback", "sensor_msgs/JoyFeedbackArray"),
        ("/navsat/vel", "geometry_msgs/TwistStamped"),
        ("/base/vel", "geometry_msgs/TwistWithCovarianceStamped"),
        ("/drive/set_odometry", "control_msgs/srv/SetOdometry"),
        ("/", ""),
    ],
)
@pytest.mark.parametrize("means", [Means.TOPIC, Means.SERVICE])
def test_what_moves_nothing(name, type, means):
    assert thing_of(name, type, means) is None


def test_a_service_of_nav2_moves_nothing_but_its_goals_do():
    assert thing_of("/scan/add_zone", "nav2_msgs/srv/AddExclusionZone", SERVICE) is None
    assert thing_of("/x", "nav2_msgs/action/Spin", ACTION) is Thing.BASE


@pytest.mark.parametrize(
    ("name", "type", "may_be"),
    [
        ("/trim_event", FLOAT, True),
        ("/flaps", "own/Flaps", True),
        ("/robot_info/request", BOOL, False),
        ("/set_led_color", "std_msgs/String", False),
        ("/light_control", "own/Light", False),
        ("/scan_i2c_bus", "own/Scan", False),
        ("/arduino/encoders", "own/Encoders", False),
        ("/camera_tilt", "own/Angle", True),
        ("/camera_exposure", "own/Exposure", False),
        ("/scan_area", "own/Scan", True),
        ("/imu/calibrate", BOOL, False),
        ("/status", "std_msgs/String", False),
    ],
)
def test_what_a_driver_hears_may_be_a_command(name, type, may_be):
    assert may_be_command(name, type) is may_be


def test_what_sets_actuators_is_before_a_goal_and_a_head_is_last():
    found = (
        ("/m/setpoint_raw/attitude", "mavros_msgs/AttitudeTarget", TOPIC),
        ("/m/setpoint_position/local", "geometry_msgs/PoseStamped", TOPIC),
        ("/m/mission/push", "mavros_msgs/WaypointPush", SERVICE),
        ("/m/cmd/command_int", "mavros_msgs/CommandInt", SERVICE),
        ("/m/mount_control/command", "mavros_msgs/MountControl", TOPIC),
    )
    ranks = [vagueness(*each) for each in found]
    assert ranks == sorted(set(ranks))


@pytest.mark.parametrize("type", ["StatusText", "CommandAck", "CommandTriggerControl", "Tunnel"])
def test_what_mavros_only_tells_on_moves_nothing(type):
    assert thing_of("/mavros/x/send_command", f"mavros_msgs/{type}", TOPIC) is None
