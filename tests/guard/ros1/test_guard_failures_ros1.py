"""Limits, rules and failures between real nodes: what a driver is told when something dies."""

import signal
from dataclasses import replace
from itertools import pairwise

import pytest
from driven_base import CMD_VEL_GUARD, Driven, drive_plan, start_guard
from harness import wait_for
from rostopic import IMAGE, TWIST, TopicEcho, say
from traffic_light import MSRCN_NODE, RED, Light

from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    Area,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    Point,
    PolicyName,
    StopProfile,
    Supervision,
)

pytestmark = pytest.mark.ros1
DRIVEN = ("/cmd_vel:=/rtron/cmd_vel/out",)
SPEED = 0.8
STOP = StopProfile(decel=0.25, within=5 * SECOND, period=SECOND // 20)
"""So slow that a busy machine which leaves out some messages makes no step of the ramp."""
SUPERVISION = Supervision(stall_after=SECOND // 5)
"""The guard brakes in these tests, not the supervisor of one that is late on a busy machine."""
MOVING = GuardedTopic(
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    flows=(Flow(name="flow1", publisher="/nav", silent_after=SECOND),),
    successors=("/driver",),
)


@pytest.fixture
def driven(ros1, driver):
    found = Driven(ros1.folder / "driven.txt")
    ros1.spawn(driver, found.path, "__name:=driver", *DRIVEN)
    ros1.wait_for_nodes("/driver")
    return found


def limited(policy, topic, **more):
    rsrcn = RSRCN(id="rsrcn", mode=Mode.ENFORCE, policy=policy, vflows=(topic,), **more)
    monitor = FpsMonitor(id="fps_detector", node="/detector", topic="/detector/image")
    return Plan(app="base", rsrcn=rsrcn, fps_monitor=(monitor,), stop=STOP, supervision=SUPERVISION)


def missioned(aflows, eflows, rules, **more):
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=aflows,
        eflows=eflows,
        rules=rules,
        **more,
    )
    return Plan(app="base", msrcn=msrcn, stop=STOP, supervision=SUPERVISION)


def navigate(ros1, speed=SPEED):
    remap = "/cmd_vel:=/rtron/cmd_vel/flow1"
    return say(ros1, "nav", "/cmd_vel", "geometry_msgs/Twist", TWIST % speed, 20, remap)


def speeds(driven):
    return [float(x) for x, _ in driven.messages()]


def wait_for_speed(driven, speed, what):
    wait_for(lambda: speeds(driven)[-1:] == [pytest.approx(speed, abs=1e-6)], what=what)


def fall_of(told):
    """Return what was told from the last full speed down to rest."""
    top = max(n for n, speed in enumerate(told) if speed >= SPEED - 1e-6)
    return told[top : told.index(0.0, top) + 1]


def assert_ramped_to_rest(told, guard):
    """Assert that the fall to 0 was no step: each message at most a little slower.

    Where the log says that the supervisor braked too, for a guard that stood still, the two ramps
    alternate.
    """
    fall = fall_of(told)
    assert len(fall) > 5
    assert max(abs(one - other) for one, other in pairwise(fall)) <= 0.11
    if "the guard stands still: the robot is stopped" not in guard.log:
        assert all(one > other for one, other in pairwise(fall)), fall


def test_the_attack_on_the_maximal_velocity_is_held_at_the_limit(ros1):
    topic = GuardedTopic(
        topic="/control/max_vel",
        type="std_msgs/Float64",
        flows=(
            Flow(name="vflow1", publisher="/decider"),
            Flow(name="vflow2", publisher="/tb3_monitor"),
        ),
        successors=("/driver",),
    )
    plan = limited(PolicyName.CONSTRAIN, topic, max_vel_limit=0.22)
    start_guard(ros1, plan, "/rtron/rsrcn")
    out = f"{topic.topic}:=/rtron{topic.topic}/out"
    heard = TopicEcho(ros1, "driver", topic.topic, out)
    flows = [f"{topic.topic}:=/rtron{topic.topic}/{flow.name}" for flow in topic.flows]
    say(ros1, "decider", topic.topic, "std_msgs/Float64", "0.22", 5, flows[0])
    heard.wait_for(lambda rows: rows, "the decider's limit")
    say(ros1, "tb3_monitor", topic.topic, "std_msgs/Float64", "2.0", 50, flows[1])
    wait_for(lambda: ros1.received("/rtron/rsrcn", flows[1].split("=")[1]) > 200, what="attack")
    rows = heard.wait_for(lambda rows: len(rows) > 200, "what the guard made of the attack")
    assert {value for row in rows for value in row} == {0.22}


def test_without_the_guard_the_attack_on_the_maximal_velocity_succeeds(ros1):
    heard = TopicEcho(ros1, "driver", "/control/max_vel")
    say(ros1, "decider", "/control/max_vel", "std_msgs/Float64", "0.22", 5)
    say(ros1, "tb3_monitor", "/control/max_vel", "std_msgs/Float64", "2.0", 50)
    assert heard.wait_for(lambda rows: [2.0] in rows, "the attack")


def test_a_dead_image_node_brings_the_robot_to_rest_on_a_ramp(ros1, driven):
    start_guard(ros1, limited(PolicyName.SAFE, MOVING, threshold=0.1), "/rtron/rsrcn")
    detector = say(ros1, "detector", "/detector/image", "sensor_msgs/Image", IMAGE, 20)
    navigate(ros1)
    wait_for_speed(driven, SPEED, "the speed that the frame rate allows")
    detector.kill()
    wait_for_speed(driven, 0.0, "rest")
    fall = fall_of(speeds(driven))
    assert all(one >= other for one, other in pairwise(fall))
    assert fall[-2] < SPEED / 4
    assert max(speeds(driven)) <= SPEED
    wait_for(lambda: "fps_detector silent" in told(ros1), what="the reason in the diagnostics")


def told(ros1):
    """Return the diagnostics as `name: message` lines."""
    text = ros1.run("rostopic", "echo", "-n", "1", "/diagnostics")
    names = [line.split(": ", 1)[1] for line in text.splitlines() if " name: " in line]
    said = [line.split(": ", 1)[1] for line in text.splitlines() if " message: " in line]
    return "\n".join(f"{n} {m}".replace('"', "") for n, m in zip(names, said, strict=True))


@pytest.mark.long
@pytest.mark.parametrize(
    ("event", "yaml"),
    [
        (
            EventFlow(
                name="low",
                topic="/battery",
                publisher="/battery",
                type="sensor_msgs/BatteryState",
                when="event.percentage < 0.2",
            ),
            "{percentage: 0.9}",
        ),
        (
            EventFlow(
                name="low",
                topic="/person",
                publisher="/battery",
                type="std_msgs/Bool",
                when="event.data",
                present=SECOND // 2,
            ),
            "{data: false}",
        ),
    ],
    ids=["battery", "event"],
)
def test_a_dead_event_node_stops_the_robot(ros1, driven, event, yaml):
    rule = MissionRule(name="careful", when="low", block=("/cmd_vel",), reason="charge first")
    guard = start_guard(ros1, missioned((MOVING,), (event,), (rule,)), "/rtron/msrcn")
    source = say(ros1, "battery", event.topic, event.type, yaml)
    navigate(ros1)
    wait_for_speed(driven, SPEED, "navigation")
    source.kill()
    wait_for_speed(driven, 0.0, "rest")
    assert_ramped_to_rest(speeds(driven), guard)
    rest = len(speeds(driven))
    wait_for_navigation_to_go_on(ros1)
    assert set(speeds(driven)[rest:]) <= {0.0}
    assert "rule careful: charge first (not known: low)" in told(ros1)


def wait_for_navigation_to_go_on(ros1):
    def heard():
        return ros1.received(MSRCN_NODE, "/rtron/cmd_vel/flow1")

    before = heard()
    wait_for(lambda: heard() > before + 20, what="navigation, which goes on")


@pytest.mark.long
def test_an_event_stops_the_robot_and_its_end_lets_it_go_on(ros1, driven):
    rule = MissionRule(name="light", when="red", block=("/cmd_vel",))
    guard = start_guard(ros1, missioned((MOVING,), (RED,), (rule,)), MSRCN_NODE)
    light = Light(ros1, "green")
    navigate(ros1)
    wait_for_speed(driven, SPEED, "navigation")
    light.turn("red")
    wait_for_speed(driven, 0.0, "rest")
    assert_ramped_to_rest(speeds(driven), guard)
    rest = len(speeds(driven))
    wait_for_navigation_to_go_on(ros1)
    assert set(speeds(driven)[rest:]) <= {0.0}
    light.turn("green")
    wait_for_speed(driven, SPEED, "navigation again")


@pytest.mark.long
def test_a_goal_in_the_unstable_area_is_blocked(ros1):
    corners = ((2.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0))
    area = Area(name="unstable", frame="map", polygon=tuple(Point(x=x, y=y) for x, y in corners))
    rule = MissionRule(
        name="network",
        action="inside(action.pose.position, unstable)",
        block=("/move_base_simple/goal",),
        reason="no network there",
    )
    topic = GuardedTopic(
        topic="/move_base_simple/goal",
        type="geometry_msgs/PoseStamped",
        flows=(
            Flow(name="aflow1", publisher="/goal_source"),
            Flow(name="aflow2", publisher="/tb3_monitor"),
        ),
        successors=("/move_base",),
    )
    start_guard(ros1, missioned((topic,), (), (rule,), areas=(area,)), "/rtron/msrcn")
    out = f"{topic.topic}:=/rtron{topic.topic}/out"
    heard = TopicEcho(ros1, "move_base", topic.topic, out)
    goal = "{header: {frame_id: map}, pose: {position: {x: %s, y: 1.0}, orientation: {w: 1.0}}}"
    flows = [f"{topic.topic}:=/rtron{topic.topic}/{flow.name}" for flow in topic.flows]
    pose = "geometry_msgs/PoseStamped"
    say(ros1, "tb3_monitor", topic.topic, pose, goal % 3.0, 10, flows[1])
    wait_for(lambda: ros1.received("/rtron/msrcn", flows[1].split("=")[1]) > 20, what="attack")
    say(ros1, "goal_source", topic.topic, pose, goal % 1.0, 10, flows[0])
    rows = heard.wait_for(lambda rows: len(rows) > 10, "the goal outside the area")
    assert {row[2] for row in rows} == {1.0}
    assert "rule network: no network there" in ros1.run(
        "rostopic", "echo", "-n", "1", "/diagnostics"
    )


def test_an_override_lets_the_robot_go_faster_until_it_expires(ros1, driven):
    plan = limited(PolicyName.CONSTRAIN, MOVING, max_vel_limit=SPEED / 2)
    door = ros1.folder / "door" / "guard.sock"
    start_guard(ros1, plan, "/rtron/rsrcn", "--control-socket", door)
    navigate(ros1)
    wait_for_speed(driven, SPEED / 2, "the limited navigation")
    words = ("override", "rsrcn", "--plan", ros1.folder / "rtron.yaml", "--control-socket", door)
    asked = ros1.rtron(*words, "--for", "3s", "--reason", "docking")
    wait_for_speed(driven, SPEED, "the navigation that is not limited")
    wait_for(lambda: asked.ended, what="rtron override")
    assert asked.log == "rsrcn is overridden for 3 s\n"
    wait_for_speed(driven, SPEED / 2, "the limit's return")


@pytest.mark.long
def test_a_dead_navigation_brings_the_robot_to_rest(ros1, driven):
    plan = limited(PolicyName.CONSTRAIN, MOVING, max_vel_limit=SPEED)
    guard = start_guard(ros1, plan, "/rtron/rsrcn")
    nav = navigate(ros1, speed=3.0)
    wait_for_speed(driven, SPEED, "the limited navigation")
    nav.kill()
    wait_for_speed(driven, 0.0, "rest")
    assert_ramped_to_rest(speeds(driven), guard)
    assert max(speeds(driven)) <= SPEED


LONG = 10 * SECOND
SPINNING = "{linear: {x: 0.2}, angular: {x: 31.0}}"
FLOW1, FLOW2 = "/cmd_vel:=/rtron/cmd_vel/flow1", "/cmd_vel:=/rtron/cmd_vel/flow2"


@pytest.mark.long
def test_a_turn_that_no_base_drives_does_not_keep_the_robot_going(ros1):
    """Each part of a stop ends in its time, and all within the bound of the plan."""
    plan = limited(PolicyName.SAFE_CONSTRAIN, MOVING, threshold=0.02, max_vel_limit=0.22)
    rule = MissionRule(name="light", when="red", block=("/cmd_vel",))
    mission = missioned((MOVING,), (RED,), (rule,)).msrcn
    stop = StopProfile()
    start_guard(ros1, replace(plan, msrcn=mission, stop=stop), MSRCN_NODE)
    heard = TopicEcho(ros1, "driver", "/cmd_vel", *DRIVEN)
    say(ros1, "detector", "/detector/image", "sensor_msgs/Image", IMAGE, 30)
    light = Light(ros1, "green")
    say(ros1, "nav", "/cmd_vel", "geometry_msgs/Twist", SPINNING, 20, FLOW1)
    full = [0.2, 0.0, 0.0, 31.0, 0.0, 0.0]
    heard.wait_for(lambda rows: full in rows, "navigation")
    light.turn("red")
    rows = heard.wait_for(lambda rows: rows[-1] == [0.0] * 6, "rest")
    last = max(n for n, row in enumerate(rows) if row == full)
    wave = rows[last + 1 : rows.index([0.0] * 6, last)]
    assert len(wave) <= stop.within / stop.period + 2
    driven = [row[0] for row in wave if row[0]]
    assert len(driven) <= 0.2 / stop.decel * SECOND / stop.period + 2
    assert all(one >= other for one, other in pairwise(row[3] for row in wave))


@pytest.mark.long
def test_what_the_base_does_not_use_never_reaches_it(ros1):
    plan = drive_plan()
    (node,) = plan.grcn
    uses = replace(node, uses=("linear.x", "angular.z"))
    start_guard(ros1, replace(plan, grcn=(uses,)), CMD_VEL_GUARD)
    heard = TopicEcho(ros1, "driver", "/cmd_vel", *DRIVEN)
    say(ros1, "nav", "/cmd_vel", "geometry_msgs/Twist", SPINNING, 20, FLOW1)
    rows = heard.wait_for(lambda rows: len(rows) > 20, "navigation")
    assert {tuple(row[1:]) for row in rows} == {(0.0,) * 5}


@pytest.mark.parametrize("bad", [".nan", ".inf", "-.inf"])
def test_what_is_no_number_never_reaches_the_base(ros1, driven, bad):
    """A GRCN alone never looked into a velocity."""
    start_guard(ros1, drive_plan(), CMD_VEL_GUARD)
    nav = navigate(ros1)
    wait_for_speed(driven, SPEED, "navigation")
    nav.kill()
    text = TWIST % bad
    say(ros1, "nav", "/cmd_vel", "geometry_msgs/Twist", text, 50, FLOW1)
    reason = "NaN or Inf is no velocity"
    wait_for(lambda: reason in ros1.run("rostopic", "echo", "-n", "1", "/diagnostics"), what=reason)
    wait_for_speed(driven, 0.0, "rest")
    assert all(0.0 <= speed <= SPEED for speed in speeds(driven))


def patient_plan(**more):
    """Return the plan of the driven base in which a silence takes long to count."""
    plan = drive_plan()
    (node,) = plan.grcn
    flows = tuple(replace(flow, silent_after=LONG) for flow in node.flows)
    patient = replace(node, flows=flows, release_after=LONG, **more)
    return replace(plan, grcn=(patient,), stop=STOP)


def test_a_navigation_whose_connection_closes_is_dead_at_once(ros1, driven):
    guard = start_guard(ros1, patient_plan(), CMD_VEL_GUARD)
    active = ros1.spawn("rostopic", "echo", f"{CMD_VEL_GUARD}/cmd_vel/active")
    nav = navigate(ros1)
    wait_for_speed(driven, SPEED, "navigation")
    wait_for(lambda: "flow1" in active.log, what="the owner of the output")
    nav.kill()
    wait_for(lambda: "stopping" in active.log, what="the stop")
    assert "stopping: flow1 has lost its publisher" in active.log
    wait_for_speed(driven, 0.0, "rest")
    assert_ramped_to_rest(speeds(driven), guard)


@pytest.mark.long
@pytest.mark.parametrize("policy", [PolicyName.PREEMPTION, PolicyName.PRIORITY_QUEUE])
def test_the_next_in_order_drives_when_a_connection_closes(ros1, driven, policy):
    """It says less to the guard meanwhile than in the time that a silence takes."""
    start_guard(ros1, patient_plan(policy=policy, max_age=LONG), CMD_VEL_GUARD)
    nav = navigate(ros1)
    wait_for_speed(driven, SPEED, "navigation")
    say(ros1, "rogue", "/cmd_vel", "geometry_msgs/Twist", TWIST % 0.25, 20, FLOW2)

    def said():
        return ros1.received(CMD_VEL_GUARD, FLOW2.split("=")[1])

    wait_for(lambda: said() > 20, what="the other at the guard")
    assert 0.25 not in speeds(driven)
    before = said()
    nav.kill()
    wait_for(lambda: 0.25 in speeds(driven), what="the next in order")
    assert said() - before < 20 * LONG / SECOND / 2


def test_a_driver_that_takes_no_commands_is_told_by_name_until_it_takes_them(ros1, driver):
    base = ros1.spawn(driver, ros1.folder / "driven.txt", "__name:=driver", *DRIVEN)
    ros1.wait_for_nodes("/driver")
    driven = Driven(ros1.folder / "driven.txt")
    guard = start_guard(ros1, drive_plan(), CMD_VEL_GUARD)
    navigate(ros1)
    wait_for_speed(driven, SPEED, "the base to drive")
    shown = ros1.spawn("rostopic", "echo", "/diagnostics")
    stuck = "undelivered: /driver takes nothing of what is sent to it on /rtron/cmd_vel/out"
    base.tell(signal.SIGSTOP)
    wait_for(lambda: f"alarm: {stuck}" in guard.log, what="the alarm")
    wait_for(lambda: stuck in shown.log, what="the diagnostics")
    base.tell(signal.SIGCONT)
    wait_for(lambda: f"no more: {stuck}" in guard.log, what="the end of the alarm")
