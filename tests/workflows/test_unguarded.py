"""What moves the robot and stands in no coordination node is told; the rest is guarded."""

from dataclasses import replace

import pytest
from notation import graph_of

from rtron.planning.plan_doubts import open_way_doubts
from rtron.vocabulary import Mode, NodeParameter, Service, WiringFact, WiringFactKind
from rtron.workflows.plan import propose
from rtron.workflows.scan import scan_graph
from rtron.workflows.unguarded import find_unguarded_commands, last_commands

TWIST = "geometry_msgs/Twist"
NAV = f"/nav nav own\n    pub /cmd_vel {TWIST}\n"
BASE = f"/base driver own\n    sub /cmd_vel {TWIST}\n"
ARM = "/arm arm own\n    server /arm/follow control_msgs/FollowJointTrajectory\n"
PICK = "/pick pick own\n    client /arm/follow control_msgs/FollowJointTrajectory\n"
LAND = "/base driver own\n    sub /land std_msgs/Empty\n"
ARMED = LAND.replace("/land std_msgs/Empty", "/arm_motors std_msgs/Bool")
STOPPED = LAND.replace("/land std_msgs/Empty", "/estop std_msgs/Bool")
KILL = Service(node="/base", name="/base/kill", type="std_srvs/Trigger")


def scan(text, **changes):
    return scan_graph(replace(graph_of("app", text), **changes))


def enforced(plan):
    return [grcn.topic for grcn in plan.grcn if grcn.mode is Mode.ENFORCE]


@pytest.mark.parametrize(
    ("text", "topics"),
    [
        (NAV + BASE, ["/cmd_vel"]),
        (NAV.replace(TWIST, "x/DriveCmd") + BASE.replace(TWIST, "x/DriveCmd"), ["/cmd_vel"]),
        (NAV.replace("/cmd_vel", "/estop") + BASE.replace("/cmd_vel", "/estop"), []),
        (NAV + NAV.replace("/nav ", "/joy ") + BASE, ["/cmd_vel"]),
        (NAV, ["/cmd_vel"]),
        (NAV.replace("/cmd_vel", "/odom"), []),
        (BASE, ["/cmd_vel"]),
        (NAV.replace("/cmd_vel", "/odom") + BASE, ["/cmd_vel"]),
        (BASE + "    sub /base/vision_pose geometry_msgs/PoseStamped\n", ["/cmd_vel"]),
    ],
)
def test_the_last_command_is_guarded_whoever_sends_it(text, topics):
    found = scan(text)
    assert sorted(last_commands(found)) == topics
    assert enforced(propose(found).plan) == topics


ECHO = NAV + f"    pub /desired_velocity {TWIST}\n"
DVL = f"/dvl own own\n    pub /dvl/vel_raw {TWIST}\n    pub /imu sensor_msgs/Imu\n"
TWO_DVLS = DVL + DVL.replace("/dvl own", "/second own")
HEARS = f"    sub /dvl/vel_raw {TWIST}\n"
HEARS_BOTH = HEARS + f"    sub /desired_velocity {TWIST}\n"


@pytest.mark.parametrize(
    ("text", "topics"),
    [
        (ECHO + DVL + f"/dvl_to_odom own own\n{HEARS_BOTH}", ["/cmd_vel"]),
        (NAV + TWO_DVLS + f"/fusion own own\n{HEARS}", ["/cmd_vel"]),
        (NAV + TWO_DVLS + f"/rudder driver own\n{HEARS}", ["/cmd_vel", "/dvl/vel_raw"]),
    ],
)
def test_what_is_only_measured_or_listened_to_is_not_guarded(text, topics):
    assert sorted(enforced(propose(scan(text + BASE)).plan)) == topics


def told(found, plan):
    return [(each.location, each.message) for each in find_unguarded_commands(plan, found)]


def test_what_a_plan_cannot_guard_is_left_out_with_the_reason():
    found = scan(NAV + BASE, services=(KILL,))
    proposed = propose(found)
    assert [each.location for each in proposed.omitted] == ["emergency stop"]
    assert told(found, proposed.plan) == [
        (
            "emergency stop",
            "/base/kill: a plan cannot guard services: whoever reaches it can call it",
        )
    ]


def test_a_topic_that_a_plan_only_observes_is_told():
    found = scan(NAV + BASE)
    plan = propose(found).plan
    grcn = tuple(replace(each, mode=Mode.OBSERVE) for each in plan.grcn)
    observing = replace(plan, grcn=grcn, msrcn=None)
    assert told(found, plan) == []
    assert told(found, observing) == [
        ("base", "/cmd_vel: its coordination node only observes: `mode: enforce` guards it")
    ]


def test_whoever_wants_to_stop_the_robot_may():
    stop = "/stop_button own own\n    pub /estop std_msgs/Bool\n"
    found = scan(NAV + BASE + "    sub /estop std_msgs/Bool\n" + stop)
    assert "emergency stop" in [str(each.thing) for each in found.inventory]
    plan = propose(found).plan
    assert enforced(plan) == ["/cmd_vel"]
    assert told(found, plan) == []
    lands = scan(LAND + LAND.replace("/base", "/pilot").replace("sub", "pub"))
    assert last_commands(lands) == {}


def test_an_action_is_guarded_by_its_goals():
    found = scan(ARM + PICK + PICK.replace("/pick ", "/other "))
    plan = propose(found).plan
    assert enforced(plan) == ["/arm/follow/goal"]
    assert told(found, plan) == []
    assert told(found, replace(plan, grcn=(), msrcn=None)) == [
        ("arm", "/arm/follow: no coordination node enforces who sends its goals")
    ]


def test_parameters_are_no_commands_of_a_plan():
    limit = NodeParameter(node="/base", name="max_vel", value=1.0)
    found = scan_graph(replace(graph_of("app", NAV + BASE, ros=2), parameters=(limit,)))
    assert len(found.inventory) == 2
    assert told(found, propose(found).plan) == []


PAST = (
    "whoever subscribes reads the public topic; any node can publish there, and the guard only "
    "warns of it"
)


def test_a_command_that_leaves_the_launch_is_guarded_and_the_way_past_it_told():
    proposed = propose(scan(NAV))
    (grcn,) = proposed.plan.grcn
    assert ([flow.publisher for flow in grcn.flows], grcn.successors) == (["/nav"], ())
    assert proposed.omitted == ()
    (doubt,) = proposed.doubts
    assert doubt.location == "GRCN grcn_cmd_vel"
    assert doubt.message == f"which node obeys it on the robot is not known: {PAST}"


LOOK = "look at its subscriptions while the robot runs"


def unread(text, *names, wiring=()):
    graph = graph_of("app", text)
    nodes = tuple(replace(node, unread=node.name in names) for node in graph.nodes)
    return scan_graph(replace(graph, nodes=nodes, wiring=wiring))


@pytest.mark.parametrize(
    "other",
    [
        *("/door rosbridge_server", "/door foxglove_bridge", "/driver mqtt_bridge"),
        *("/driver ros1_bridge", "/driver micro_ros_agent"),
        *("/teleop keys", "/camera_driver usb", "/left/driver driver", "/e_stop base_driver"),
    ],
)
def test_a_driver_that_was_not_read_may_obey_and_nobody_else(other):
    text = NAV.replace("/cmd_vel", "/right/cmd_vel") + f"/serial driver own\n{other} third_party\n"
    proposed = propose(unread(text, "/serial", other.split()[0]))
    (grcn,) = proposed.plan.grcn
    assert grcn.successors == ("/serial",)
    doubt = next(each.message for each in proposed.doubts if "guess" in each.message)
    past = PAST.replace("/cmd_vel", "/right/cmd_vel")
    assert doubt == f"that /serial (not read) obeys it is a guess; if not, {past}"


@pytest.mark.parametrize(
    ("package", "why"),
    [
        ("driver", "not read, so what moves it is not known: give its source"),
        ("micro_ros_agent", f"what that firmware obeys is not known: {LOOK}"),
        ("rosserial_python", f"what that firmware obeys is not known: {LOOK}"),
    ],
)
def test_a_driver_that_was_not_read_is_told_beside_what_is_guarded(package, why):
    proposed = propose(unread(NAV + BASE + f"/arm_driver {package} own\n", "/arm_driver"))
    assert enforced(proposed.plan) == ["/cmd_vel"]
    (problem,) = proposed.omitted
    assert problem.message == f"/arm_driver: {why}"


def test_a_node_that_moves_hardware_without_a_command_is_told():
    link = WiringFact(kind=WiringFactKind.DEVICE, subject="/pilot", value="vehicle link")
    proposed = propose(scan(f"{NAV}{BASE}/pilot own own\n", wiring=(link,)))
    (problem,) = proposed.omitted
    why = "/pilot: it decides itself, or obeys a device or link of its own: no topic leads there"
    assert (problem.location, problem.message) == ("vehicle", why)


def test_nobody_is_guessed_where_a_node_is_known_to_obey():
    proposed = propose(unread(NAV + BASE + "/camera cam own\n", "/camera"))
    assert [grcn.successors for grcn in proposed.plan.grcn] == [("/base",)]
    assert proposed.doubts == ()


JOY = "sensor_msgs/Joy"
STICK = f"/stick joy own\n    pub /joy {JOY}\n"
TELEOP = f"/teleop keys own\n    sub /joy {JOY}\n    pub /joy_vel {TWIST}\n"
MUX = f"/mux twist_mux own\n    sub /joy_vel {TWIST}\n    sub /web_vel {TWIST}\n"
MUX += f"    pub /cmd_vel {TWIST}\n"


def test_an_input_of_an_arbiter_that_nobody_sends_is_kept_for_whom_the_plan_will_name():
    proposed = propose(scan(MUX + TELEOP + STICK + BASE))
    (grcn,) = (each for each in proposed.plan.grcn if each.topic == "/web_vel")
    assert (grcn.mode, grcn.flows, grcn.successors) == (Mode.ENFORCE, (), ("/mux",))
    (doubt,) = (each for each in proposed.doubts if each.location == f"GRCN {grcn.id}")
    assert doubt.message.startswith("it has no flow, so it keeps everybody out: ")


def test_what_else_the_only_sender_acts_on_is_told():
    found = scan(TELEOP.replace("/joy_vel", "/cmd_vel") + STICK + BASE)
    plan = propose(found).plan
    why = "not guarded: /teleop acts on what any node sends there"
    assert told(found, plan) == [("base", f"/joy: {why}")]
    behind = scan(MUX + TELEOP + STICK + BASE)
    assert ("base", f"/joy: {why}") in told(behind, propose(behind).plan)


def test_the_buttons_of_who_sends_guarded_goals_are_told():
    phone = PICK.replace("/pick pick", "/phone phone") + "    sub /go std_msgs/Bool\n"
    found = scan(ARM + PICK + phone)
    plan = propose(found).plan
    assert enforced(plan) == ["/arm/follow/goal"]
    why = "not guarded: /phone acts on what any node sends there"
    assert told(found, plan) == [("arm", f"/go: {why}")]


FIRMWARE = BASE + "/board rosserial_python own\n"


@pytest.mark.parametrize(
    ("others", "successors"),
    [
        (BASE, ("/base",)),
        (FIRMWARE, ("/base", "/board")),
        (FIRMWARE.replace("_python", "_arduino"), ("/base", "/board")),
        (FIRMWARE.replace("/board", "/left/board"), ("/base", "/left/board")),
        (BASE.replace("/base driver", "/ekf_filter robot_localization"), ()),
        (FIRMWARE.replace("/base driver", "/ekf_filter robot_localization"), ("/board",)),
    ],
)
def test_firmware_may_obey_beside_others_and_a_listener_does_not(others, successors):
    proposed = propose(unread(NAV + others, "/board", "/left/board"))
    assert [grcn.successors for grcn in proposed.plan.grcn] == [successors]
    is_open = not successors or "board" in successors[-1]
    assert [PAST in each.message for each in proposed.doubts] == [True] * is_open


def test_no_remap_takes_firmware_behind_micro_ros_to_the_guard():
    agent = "/agent micro_ros_agent own\n"
    (doubt,) = propose(unread(NAV + BASE + agent, "/agent")).doubts
    why = "firmware behind /agent may obey it, too, and no remap moves what it reads"
    assert doubt.message == f"{why}: {PAST}"


PWM = "    pub /arduino/pwm own_msgs/PWM\n"
MIXER = BASE.replace("/base driver", "/mixer mixer") + PWM
BOARD = "/board rosserial_python own\n"
GAINS = "/gains rostopic own\n    pub /motor/pid own_msgs/Gains\n"
ONCE = (WiringFact(kind=WiringFactKind.SENT_ONCE, subject="/gains"),)


@pytest.mark.parametrize(
    ("board", "successors"),
    [
        (BOARD, [("/board",)]),
        (BOARD.replace("/board", "/other/board"), []),
        (BOARD.replace("rosserial_python", "micro_ros_agent"), [()]),
        (BOARD.replace("rosserial_python", "camera"), []),
    ],
)
def test_what_goes_to_firmware_of_the_launch_is_guarded(board, successors):
    found = unread(NAV + MIXER + board, "/board", "/other/board")
    plan = propose(found).plan
    assert [g.successors for g in plan.grcn if g.topic == "/arduino/pwm"] == successors


def test_what_is_also_sent_once_is_guarded():
    once = GAINS.replace("/motor/pid own_msgs/Gains", "/arduino/pwm own_msgs/PWM")
    plan = propose(unread(NAV + MIXER + BOARD + once, "/board", wiring=ONCE)).plan
    (flows,) = [grcn.flows for grcn in plan.grcn if grcn.topic == "/arduino/pwm"]
    assert {flow.publisher for flow in flows} == {"/gains", "/mixer"}


def test_what_is_sent_once_is_refused_with_the_reason():
    found = unread(NAV + BOARD + GAINS, "/board", wiring=ONCE)
    plan = propose(found).plan
    assert enforced(plan) == ["/cmd_vel"]
    why = "sent once, and a guard keeps no command for later: guard it yourself, with `kind: state`"
    assert ("base", f"/motor/pid: {why}") in told(found, plan)


def test_what_nobody_sends_is_not_sent_once():
    device = WiringFact(kind=WiringFactKind.DEVICE, subject="/arm", value="CAN")
    found = scan("/arm driver own\n    sub /arm/goal_pos own_msgs/Arm\n", wiring=(device,))
    ((_, why),) = told(found, propose(found).plan)
    assert (
        why == "/arm/goal_pos: nobody in this launch sends it: give the launch file of who should"
    )


@pytest.mark.parametrize(
    ("other", "package", "why"),
    [
        ("/box", "box", "nobody that was read obeys it, and /box may: give the source"),
        ("/none", "box", "nobody in this launch obeys it: give the launch file of who should"),
        (
            "/left/box",
            "rosserial_python",
            f"nobody that was read obeys it, and the firmware behind /left/box may: {LOOK}",
        ),
    ],
)
def test_who_may_obey_what_leaves_the_launch_is_told(other, package, why):
    box = f"/box {package} own\n/left/box {package} own\n"
    found = unread(NAV + "    pub /arm/set_gripper std_msgs/Float64\n" + box, other)
    assert ("gripper", f"/arm/set_gripper: {why}") in told(found, propose(found).plan)


SELF = "/base publishes what it obeys: what it sends itself does not pass the guard"
LONELY = "nobody but /base may send /cmd_vel: another that is to command it needs a flow"


@pytest.mark.parametrize(("others", "told"), [(NAV, [SELF]), ("", [SELF, LONELY])])
def test_a_node_that_publishes_what_it_obeys_is_told(others, told):
    proposed = propose(scan(BASE + f"    pub /cmd_vel {TWIST}\n" + others))
    assert [each.message for each in proposed.doubts][-len(told) :] == told
    assert (LONELY in [each.message for each in proposed.doubts]) == (LONELY in told)


def test_who_may_send_is_no_doubt_where_anyone_may():
    found = scan(BASE + f"    pub /cmd_vel {TWIST}\n")
    plan = propose(found).plan
    opened = replace(plan, grcn=tuple(replace(g, block_unapproved=False) for g in plan.grcn))
    doubts = [[d.message for d in open_way_doubts(p, found.graph)] for p in (plan, opened)]
    assert doubts == [[SELF, LONELY], [SELF]]


@pytest.mark.parametrize(
    ("text", "services", "why"),
    [
        ("/chat chat own\n    pub /chatter std_msgs/String\n", (), "nothing that was read moves"),
        ("/base driver own\n", (KILL,), "/base/kill: a plan cannot guard services: whoever"),
        (LAND, (), "/land: a plan leaves switches and signals open: any node can send it"),
        (ARMED, (), "/arm_motors: a plan leaves switches and signals open: any node can send it"),
        (STOPPED, (), "/estop: a plan leaves stops open: who stops the robot may be anyone"),
    ],
)
def test_a_plan_that_guards_nothing_says_why_for_each_thing(text, services, why):
    found = scan(text, services=services)
    proposed = propose(found)
    assert enforced(proposed.plan) == []
    assert len(proposed.omitted) == max(1, len(found.inventory))
    assert proposed.omitted[0].message.startswith(why)


def test_a_command_that_nobody_here_sends_is_kept_for_whom_the_plan_will_name():
    proposed = propose(scan(BASE))
    (grcn,) = proposed.plan.grcn
    assert (grcn.flows, grcn.successors, grcn.block_unapproved) == ((), ("/base",), True)
    assert proposed.omitted == ()
    (doubt,) = proposed.doubts
    assert doubt.location == "GRCN grcn_cmd_vel"
    assert doubt.message.startswith("it has no flow, so it keeps everybody out: ")
