"""What the source of nodes is seen to do makes commands, whatever they are called."""

from dataclasses import replace

import pytest
from finding_graphs import TWIST, small_graph

from rtron.findings import app_facts, take_inventory
from rtron.reports.app.inventory_rows import mover_rows
from rtron.vocabulary import Direction, Evidence, Service, WiringFact, WiringFactKind
from rtron.vocabulary.inventory import Thing

NAV = f"/nav nav own\n    pub /cmd_vel {TWIST}\n"
CHAIN = """
/nav nav own
    pub /a x/A
/mixer p own
    sub /a x/A
    sub /b/state x/B
    sub /scan sensor_msgs/msg/LaserScan
    pub /c x/C
    pub /debug x/C
/board p own
    sub /c x/C
    sub /shown x/C
    pub /b/state x/B
"""
CAN = WiringFact(kind=WiringFactKind.DEVICE, subject="/board", value="CAN")


def place(node, topic, direction):
    return Evidence(file=f"{node}{topic}.py", line=list(Direction).index(direction) + 1)


def flow(node, topic, value="", *led):
    """Return that messages of a topic lead to a value and other topics."""
    sent = (place(node, each, Direction.PUBLISH) for each in led)
    evidence = (place(node, topic, Direction.SUBSCRIBE), *sent)
    return WiringFact(
        kind=WiringFactKind.MESSAGE_FLOW, subject=node, value=value, evidence=evidence
    )


def seen(text, *facts, **changes):
    """Return the inventory of an app of whose nodes flows were seen."""
    graph = small_graph(text, wiring=facts, **changes)
    ends = tuple(
        replace(each, evidence=(place(each.node, each.topic, each.direction),))
        for each in graph.endpoints
    )
    return take_inventory(app_facts(replace(graph, endpoints=ends)))


WAYS = (
    flow("/mixer", "/a", "", "/c", "/debug"),
    flow("/mixer", "/b/state", "", "/c"),
    flow("/mixer", "/scan", "", "/c"),
    flow("/board", "/c", "serial port", "/b/state"),
    flow("/board", "/shown", "library lcd"),
)


def test_what_is_written_to_a_device_is_a_command_and_so_is_what_leads_there():
    (mover,) = seen(CHAIN, *WAYS)
    assert (mover.thing, mover.drivers) == (Thing.DEVICE, ("/board",))
    assert {each.name: each.hops for each in mover.commands} == {"/c": 0, "/a": 1}


def test_who_could_be_a_command_by_its_name_and_leads_nowhere_is_none():
    text = f"/base_driver p own\n    sub /cmd_vel {TWIST}\n"
    assert seen(text, flow("/base_driver", "/cmd_vel")) == seen("/base_driver p own\n")


@pytest.mark.parametrize(("device", "count"), [("serial port", 0), ("servo driver", 1)])
def test_what_was_measured_moves_motors_that_nothing_else_moves(device, count):
    text = "/balance p own\n    sub /imu sensor_msgs/msg/Imu\n    sub /on std_msgs/msg/Bool\n"
    way = flow("/balance", "/imu", device)
    found = seen(text, way)
    assert [each.drivers for each in found] == [("/balance",)] * count
    told = seen(text, way, flow("/balance", "/on", device))
    assert [each.name for mover in told for each in mover.commands] == ["/on"]


def test_joints_are_moved_by_what_tells_their_states():
    text = "/arm p own\n    sub /joint_states sensor_msgs/msg/JointState\n"
    (mover,) = seen(text, flow("/arm", "/joint_states", "serial port"))
    assert [each.name for each in mover.commands] == ["/joint_states"]


def test_a_velocity_for_servos_moves_no_base_unless_a_name_says_so():
    text = f"/teleop_node p own\n    sub /cmd_vel {TWIST}\n"
    assert seen(text, flow("/teleop_node", "/cmd_vel", "servo driver"))[0].thing is Thing.SERVOS
    steered = text.replace("teleop_node", "steering")
    assert seen(steered, flow("/steering", "/cmd_vel", "servo driver"))[0].thing is Thing.BASE


@pytest.mark.parametrize(("value", "count"), [("open()", 1), ("socket()", 1), ("unknown", 0)])
def test_what_a_descriptor_is_of_is_what_the_source_opens(value, count):
    text = "/board p own\n    sub /c x/C\n"
    assert len(seen(text, flow("/board", "/c", value), CAN)) == count
    assert seen(text, flow("/board", "/c", value)) == ()


REQUEST = WiringFact(kind=WiringFactKind.REQUEST_FLOW, subject="/mixer", others=("/go",))


@pytest.mark.parametrize(
    ("led", "value", "is_listed"),
    [(("/c",), "", True), ((), "", False), ((), "unknown", True), (("/debug",), "", False)],
)
def test_a_service_counts_where_its_requests_lead_to_commands(led, value, is_listed):
    sent = tuple(place("/mixer", each, Direction.PUBLISH) for each in led)
    request = replace(REQUEST, value=value, evidence=(Evidence(file="m.py"), *sent))
    services = (Service(node="/mixer", name="/go", type="std_srvs/srv/Trigger"),)
    found = seen(CHAIN, *WAYS, request, services=services)
    assert ("/go" in {c.name for mover in found for c in mover.last_commands}) is is_listed
    assert len(found) == 1


def test_what_moves_by_itself_is_seen_to():
    moves = WiringFact(kind=WiringFactKind.SELF_MOTION, subject="/board", value="servo driver")
    opens = replace(CAN, value="servo driver")
    (mover,) = seen("/board p own\n", moves, opens)
    assert (mover.drivers, mover.commands) == (("/board",), ())
    assert seen("/board p own\n", opens) == ()
    text = "/board p own\n    sub /c x/C\n"
    (told,) = seen(text, moves, opens, flow("/board", "/c", "servo driver"))
    assert told.starting == ("/board",)
    assert any("untold" in row.text for row in mover_rows(told))


def last_commands(text, device=""):
    facts = (WiringFact(kind=WiringFactKind.DEVICE, subject=device, value="CAN"),)
    movers = take_inventory(app_facts(small_graph(text, wiring=facts if device else ())))
    return {each.name: mover.thing for mover in movers for each in mover.last_commands}


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
        ("/allocator", "/speed", "std_msgs/msg/Float64", False),
        ("/allocator", "/speed_error", "std_msgs/msg/Float32MultiArray", False),
        ("/allocator", "/numbers", "std_msgs/msg/Float32MultiArray", False),
        ("/gait", "/target_states", "sensor_msgs/msg/JointState", False),
        ("/gait", "/joint_states", "sensor_msgs/msg/JointState", False),
        ("/allocator", "/wheel/path", "nav_msgs/msg/Path", False),
    ],
)
def test_numbers_that_nobody_here_hears_leave_the_app(node, topic, type, leaves):
    found = last_commands(f"{NAV}{node} p own\n    sub /cmd_vel {TWIST}\n    pub {topic} {type}\n")
    assert (topic in found) is leaves


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
        ("/joint_states", "own/msg/joint_states", Thing.SERVOS),
        ("/joint_states", "sensor_msgs/msg/JointState", Thing.SERVOS),
        ("/leg_state", "own/msg/Angles", Thing.SERVOS),
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


def test_states_of_joints_that_nobody_here_sends_are_open():
    text = "/board own own\n    sub /joint_states sensor_msgs/msg/JointState\n"
    assert last_commands(text, "/board") == {"/joint_states": Thing.SERVOS}


def test_moveit_moves_nothing_where_its_execution_is_fake():
    goals = "/move_group m third_party\n    server /move_group moveit_msgs/action/MoveGroup\n"
    fake = "    pub /move_group/fake_controller_joint_states sensor_msgs/msg/JointState\n"
    assert [mover.thing for mover in seen(goals)] == [Thing.ARM]
    assert seen(goals + fake) == ()


RELAYED = f"""
/teleop p own
    pub /teleop/cmd_vel {TWIST}
/safety p own
    sub /teleop/cmd_vel {TWIST}
    pub /cmd_vel {TWIST}
/base_driver p own
    sub /cmd_vel {TWIST}
"""


def test_what_a_library_makes_of_a_message_may_be_what_its_node_sends():
    given = flow("/safety", "/teleop/cmd_vel", "library logic.Safety()")
    (mover,) = seen(RELAYED, given, flow("/base_driver", "/cmd_vel", "serial port"))
    assert (mover.drivers, mover.arbiters) == (("/base_driver",), ())
    assert {each.name: each.hops for each in mover.commands} == {
        "/cmd_vel": 0,
        "/teleop/cmd_vel": 1,
    }


@pytest.mark.parametrize(("reader", "count"), [("", 1), (f"    sub /cmd_vel/applied {TWIST}\n", 0)])
def test_a_driver_that_tells_nobody_here_what_it_was_told_obeys_it(reader, count):
    text = f"/board p own\n    sub /cmd_vel {TWIST}\n    pub /cmd_vel/applied {TWIST}\n"
    text += f"/other p own\n    pub /x x/A\n{reader}"
    found = seen(text, CAN, flow("/board", "/cmd_vel", "", "/cmd_vel/applied"))
    assert sum(each.drivers == ("/board",) for each in found) == count


def test_a_driver_obeys_signals_beside_velocities_where_its_writes_are_not_seen():
    text = f"/board p own\n    sub /cmd_vel {TWIST}\n    sub /dock std_msgs/msg/UInt8\n"
    text += "    pub /info x/Info\n"
    ways = (flow("/board", topic, "", "/info") for topic in ("/cmd_vel", "/dock"))
    (mover,) = seen(text, CAN, *ways)
    assert {each.name for each in mover.commands} == {"/cmd_vel", "/dock"}


def test_a_velocity_is_told_whose_way_ends_at_nodes_that_are_not_followed():
    text = f"/gait p own\n    sub /cmd_vel {TWIST}\n    pub /steps x/Steps\n"
    text += "/legs p own\n    sub /steps x/Steps\n"
    (mover,) = seen(text, flow("/gait", "/cmd_vel", "", "/steps"), flow("/legs", "/steps"))
    assert (mover.thing, mover.drivers) == (Thing.BASE, ("/gait",))
