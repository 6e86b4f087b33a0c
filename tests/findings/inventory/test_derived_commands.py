"""What nodes make of commands moves the robot, whatever it is called."""

import pytest
from finding_graphs import TWIST, small_graph

from rtron.findings import app_facts, take_inventory
from rtron.vocabulary import WiringFact, WiringFactKind
from rtron.vocabulary.inventory import Thing

NAV = f"/nav nav own\n    pub /cmd_vel {TWIST}\n"
WHEELS = f"/kinematics p own\n    sub /cmd_vel {TWIST}\n    pub /wheel_states p/msg/WheelStates\n"
BOARD = """
/wheel_driver p own
    sub /wheel_states p/msg/WheelStates
    pub /board/frames p/msg/Frame
/lamp_driver p own
    pub /board/frames p/msg/Frame
/board p own
    sub /board/frames p/msg/Frame
"""
CAN = WiringFact(kind=WiringFactKind.DEVICE, subject="/board", value="CAN")


def last_commands(text, device=""):
    facts = (WiringFact(kind=WiringFactKind.DEVICE, subject=device, value="CAN"),)
    movers = take_inventory(app_facts(small_graph(text, wiring=facts if device else ())))
    return {each.name: mover.thing for mover in movers for each in mover.last_commands}


def test_the_frames_for_a_board_are_what_moves_the_wheels():
    assert last_commands(NAV + WHEELS + BOARD, "/board") == {"/board/frames": Thing.BASE}


def test_a_vague_command_that_is_made_of_a_velocity_moves_what_that_moves():
    rover = f"/rover p own\n    sub /cmd_vel {TWIST}\n    pub /cmd_corner p/msg/CornerCommand\n"
    corners = "/corner_driver p own\n    sub /cmd_corner p/msg/CornerCommand\n"
    assert last_commands(NAV + rover + corners, "/corner_driver") == {"/cmd_corner": Thing.BASE}
    alone = rover.replace(f"    sub /cmd_vel {TWIST}\n", "")
    assert last_commands(alone + corners, "/corner_driver") == {"/cmd_corner": Thing.DEVICE}


def test_states_that_a_driver_sends_are_no_command():
    tells = (
        f"/base_driver p own\n    sub /cmd_vel {TWIST}\n    pub /wheel_states p/msg/WheelStates\n"
    )
    hears = "/motor_display p own\n    sub /wheel_states p/msg/WheelStates\n"
    assert last_commands(NAV + tells + hears, "/base_driver") == {"/cmd_vel": Thing.BASE}


@pytest.mark.parametrize(
    ("node", "topic", "type", "leaves"),
    [
        ("/allocator", "/board/drive_pulse", "std_msgs/msg/UInt16MultiArray", True),
        ("/allocator", "/thrusters/left/wrench", "geometry_msgs/msg/WrenchStamped", True),
        ("/allocator", "/speed", "std_msgs/msg/Float64", False),
        ("/wheel_controller", "/left_wheel_speed", "std_msgs/msg/Float64", True),
        ("/allocator", "/speed_error", "std_msgs/msg/Float32MultiArray", False),
        ("/allocator", "/numbers", "std_msgs/msg/Float32MultiArray", False),
        ("/gait", "/target_angles", "sensor_msgs/msg/JointState", True),
        ("/gait", "/target_states", "sensor_msgs/msg/JointState", False),
        ("/gait", "/joint_states", "sensor_msgs/msg/JointState", False),
        ("/allocator", "/wheel/path", "nav_msgs/msg/Path", False),
    ],
)
def test_numbers_that_nobody_here_hears_leave_the_app(node, topic, type, leaves):
    found = last_commands(f"{NAV}{node} p own\n    sub /cmd_vel {TWIST}\n    pub {topic} {type}\n")
    assert (topic in found) is leaves


def test_a_setpoint_beside_a_command_that_is_obeyed_only_tells():
    told = f"    pub /desired_velocity {TWIST}\n"
    found = last_commands(NAV + WHEELS + told + BOARD, "/board")
    assert found == {"/board/frames": Thing.BASE}
    stamped = f"    pub /cmd_vel_stamped {TWIST}Stamped\n"
    assert last_commands(NAV + stamped + WHEELS + BOARD, "/board") == found
    alone = f"/nav nav own\n    pub /desired_velocity {TWIST}\n"
    assert last_commands(alone) == {"/desired_velocity": Thing.BASE}


@pytest.mark.parametrize("name", ["/log_collector", "/robot_status", "/led_node", "/web_report"])
def test_who_keeps_a_log_or_shows_obeys_no_command(name):
    base = f"/base_driver p own\n    sub /cmd_vel {TWIST}\n"
    listener = f"{name} p own\n    sub /cmd_vel {TWIST}\n"
    graph = small_graph(NAV + base + listener)
    (mover,) = take_inventory(app_facts(graph))
    assert mover.drivers == ("/base_driver",)


JOINTS = """
/gait own own
    pub {topic} {type}
/robot_state_publisher rsp third_party
    sub {topic} {type}
/board own own
    sub {topic} {type}
"""


@pytest.mark.parametrize(
    ("topic", "type", "thing"),
    [
        ("/joint_states", "own/msg/joint_states", Thing.ARM),
        ("/joint_states", "sensor_msgs/msg/JointState", Thing.ARM),
        ("/leg_state", "own/msg/Angles", Thing.ARM),
        ("/state", "own/msg/WheelStates", Thing.BASE),
        ("/robot_state", "own/msg/RobotState", None),
        ("/led/_motors", "std_msgs/msg/Int32", None),
        ("/joint_states", "diagnostic_msgs/msg/DiagnosticArray", None),
    ],
)
def test_states_of_joints_that_hardware_hears_from_who_has_none_are_commands(topic, type, thing):
    text = JOINTS.format(topic=topic, type=type)
    assert last_commands(text) == {}
    assert last_commands(text, "/board") == ({topic: thing} if thing else {})
    assert last_commands(text.replace("/gait own", "/gait mavros"), "/board") == {}
    measured = text.replace("/board own own", "/board own own\n    pub /imu sensor_msgs/Imu")
    assert last_commands(measured, "/board") == {}
    (mover,) = take_inventory(app_facts(small_graph(text, wiring=(CAN,)))) if thing else (None,)
    assert not mover or mover.drivers == ("/board",)


def test_what_a_node_tells_of_its_own_state_is_no_command_though_a_driver_hears_it():
    told = "    pub /logic/current_state p/msg/LogicStates\n"
    logic = f"/logic p own\n    sub /cmd_vel {TWIST}\n    pub /base/cmd_vel {TWIST}\n{told}"
    hears = "    sub /logic/current_state p/msg/LogicStates\n"
    base = f"/base_driver p own\n    sub /base/cmd_vel {TWIST}\n{hears}"
    assert last_commands(NAV + logic + base, "/base_driver") == {"/base/cmd_vel": Thing.BASE}


def test_what_a_driver_tells_does_not_make_it_the_source_of_what_it_obeys():
    told = "{} /base/power p/msg/Power\n"
    logic = f"/logic p own\n    sub /cmd_vel {TWIST}\n    pub /logic_vel {TWIST}\n"
    mux = f"/relay p own\n    sub /logic_vel {TWIST}\n    pub /base/cmd_vel {TWIST}\n"
    base = f"/base_driver p own\n    sub /base/cmd_vel {TWIST}\n"
    text = NAV + logic + told.format("    sub") + mux + base + told.format("    pub")
    assert last_commands(text, "/base_driver") == {"/base/cmd_vel": Thing.BASE}


@pytest.mark.parametrize(
    ("topic", "type", "leaves"),
    [
        ("/tether/manipulator_control", "own/msg/Manip", True),
        ("/tether/manipulator_control", "std_msgs/msg/Bool", False),
        ("/tether/manipulator_status", "own/msg/Manip", False),
        ("/tether/stream_control", "own/msg/Stream", False),
    ],
)
def test_an_order_to_a_part_leaves_the_app_though_a_driver_sends_and_a_viewer_hears_it(
    topic, type, leaves
):
    serves = "    sub /joy sensor_msgs/msg/Joy\n    sub /base/cmd own/msg/Cmd\n"
    text = f"/link own own\n    pub {topic} {type}\n{serves}/gui own own\n    sub {topic} {type}\n"
    assert (topic in last_commands(text, "/link")) is leaves


def test_states_of_joints_that_nobody_here_sends_are_open():
    text = "/board own own\n    sub /joint_states sensor_msgs/msg/JointState\n"
    assert last_commands(text, "/board") == {"/joint_states": Thing.ARM}
