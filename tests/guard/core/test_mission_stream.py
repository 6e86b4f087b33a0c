"""Rules of the mission on real messages: events set bits, bits and fields block actions."""

import struct
from dataclasses import replace

import pytest
from streams import TWIST, peer
from velocity_messages import speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.observations import MAX_EVENT, observations_of
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    Area,
    Domain,
    EventFlow,
    Flow,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    Point,
    PolicyName,
    Sharing,
    StreamKind,
    Transform,
    WhenUnknown,
    build_streams,
)

STRING = TypeInfo("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1")
POSE = TypeInfo("geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5")
NAV, OUT = "/rtron/cmd_vel/aflow1", "/rtron/cmd_vel/out"
MOVING = GuardedTopic(
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    flows=(
        Flow(name="aflow1", publisher="/nav", silent_after=60 * SECOND),
        Flow(name="aflow2", publisher="/teleop", silent_after=60 * SECOND),
    ),
    successors=("/driver",),
)
GOALS = GuardedTopic(
    topic="/goal",
    type="geometry_msgs/PoseStamped",
    flows=(Flow(name="aflow3", publisher="/monitor"),),
    successors=("/move_base",),
)
ALERTS = GuardedTopic(
    topic="/alert",
    type="std_msgs/String",
    flows=(Flow(name="aflow4", publisher="/voice"),),
    successors=("/speaker",),
)
LIGHT = EventFlow(
    name="red",
    topic="/light",
    publisher="/camera",
    type="std_msgs/String",
    when="event.data == 'red'",
)
AT_RED = MissionRule(name="red_light", when="red", block=("/cmd_vel",), reason="the light is red")
UNSTABLE = Area(
    name="unstable",
    frame="map",
    polygon=(Point(x=2.0, y=0.0), Point(x=4.0, y=0.0), Point(x=4.0, y=2.0), Point(x=2.0, y=2.0)),
)
KEEP_OUT = MissionRule(
    name="keep_out",
    action="inside(action.pose.position, unstable)",
    block=("/goal",),
    reason="no network there",
)


def string(text):
    data = text.encode()
    return struct.pack("<II", 4 + len(data), len(data)) + data


def pose(x, y, frame="map"):
    name = frame.encode()
    body = struct.pack("<IIII", 0, 0, 0, len(name)) + name + struct.pack("<7d", x, y, 0, 0, 0, 0, 1)
    return struct.pack("<I", len(body)) + body


def guarded(aflows=(MOVING,), eflows=(LIGHT,), rules=(AT_RED,), grcn=(), rsrcn=None, **more):
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=tuple(aflows),
        eflows=tuple(eflows),
        rules=tuple(rules),
        **more,
    )
    plan = Plan(app="test", msrcn=msrcn, grcn=grcn, rsrcn=rsrcn)
    transport = MemoryTransport()
    host = Coordinator(transport, build_streams(plan), observations_of(plan))
    host.open()
    return transport, host


def light(transport):
    return transport.publisher("/light", peer("/camera", STRING))


def test_an_event_blocks_the_action_and_stops_the_robot_with_the_reason():
    transport, host = guarded()
    driver, active = transport.listen(OUT), transport.listen("/rtron/msrcn/cmd_vel/active")
    nav, lamp = transport.publisher(NAV, peer("/nav")), light(transport)
    lamp(string("green"))
    nav(twist(1.0))
    lamp(string("red"))
    transport.advance(0)
    assert [x for x, _ in speeds(driver)] == pytest.approx([1.0, 0.875])
    assert active[-1].endswith(b"stopping: rule red_light: the light is red")
    nav(twist(1.0))
    transport.advance(SECOND)
    assert speeds(driver)[-1] == (0.0, 0.0)
    assert host.streams[0].pipeline.tallies["aflow1"].dropped == 1
    lamp(string("green"))
    nav(twist(0.5))
    assert speeds(driver)[-1] == (0.5, 0.0)


def test_nothing_moves_before_the_first_event_nor_when_it_is_too_old_nor_when_its_node_is_gone():
    transport, _ = guarded()
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    nav(twist(1.0))
    lamp = light(transport)
    nav(twist(1.0))
    assert driver == []
    lamp(string("green"))
    nav(twist(1.0))
    assert len(driver) == 1
    transport.leave("/light", peer("/camera", STRING))
    nav(twist(1.0))
    lamp = light(transport)
    lamp(string("green"))
    transport.advance(2 * SECOND)
    before = len(driver)
    nav(twist(1.0))
    assert all(x < 1.0 for x, _ in speeds(driver)[1:])
    assert all(x < 1.0 for x, _ in speeds(driver)[before:])


def test_events_that_were_lost_are_counted_and_shown_while_it_is_news():
    transport, host = guarded()
    light(transport)(string("green"))
    assert host.lost_events() == {}
    transport.miss("/light", peer("/camera", STRING), 3)
    transport.miss("/light", peer("/camera", STRING), 2)

    def state():
        return next((each for each in host.statuses() if "events on /light" in each.name), None)

    assert (state().level, state().values) == (1, {"lost of /camera": "5"})
    assert "5 events were lost" in state().message
    assert host.lost_events() == {"/light": 5}
    transport.advance(11 * SECOND)
    assert (state().level, state().values) == (0, {"lost of /camera": "5"})


@pytest.mark.parametrize(
    ("counts", "passes"),
    [(WhenUnknown.BLOCK, 0), (WhenUnknown.SET, 0), (WhenUnknown.CLEAR, 1), (WhenUnknown.KEEP, 1)],
)
def test_what_silence_counts_as_is_the_plan_s_to_say(counts, passes):
    transport, _ = guarded(eflows=(replace(LIGHT, on_silence=counts),))
    driver = transport.listen(OUT)
    light(transport)(string("green"))
    transport.advance(3 * SECOND)
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    assert len(driver) == passes


@pytest.mark.parametrize(
    "bad", [b"", b"\x01", string("x")[:-1], string("x") + b"\x00", b"\xff" * 9]
)
def test_an_event_that_cannot_be_read_blocks(bad):
    transport, _ = guarded()
    driver = transport.listen(OUT)
    lamp = light(transport)
    lamp(string("green"))
    lamp(bad)
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    assert driver == []


@pytest.mark.parametrize(
    "liar",
    [
        peer("/liar", STRING),
        peer("/camera", STRING, verified=False),
        peer("/camera", replace(STRING, md5sum="another")),
    ],
)
def test_only_the_planned_publisher_of_the_planned_type_is_heard(liar):
    transport, _ = guarded()
    driver = transport.listen(OUT)
    transport.publisher("/light", liar)(string("green"))
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    assert driver == []


def test_a_goal_inside_the_unstable_area_is_blocked_with_the_reason():
    transport, host = guarded((GOALS,), (), (KEEP_OUT,), areas=(UNSTABLE,))
    planner = transport.listen("/rtron/goal/out")
    monitor = transport.publisher("/rtron/goal/aflow3", peer("/monitor", POSE))
    for message in (pose(1.0, 1.0), pose(3.0, 1.0), pose(2.0, 0.0), pose(5.0, 1.0)):
        monitor(message)
    assert planner == [pose(1.0, 1.0), pose(5.0, 1.0)]
    tally = host.streams[0].pipeline.tallies["aflow3"]
    assert tally.dropped == 2
    monitor(pose(3.0, 1.0))
    assert tally.last.reason == "rule keep_out: no network there"


def test_a_goal_in_another_frame_is_blocked_unless_a_transform_is_configured():
    transform = Transform(source="odom", target="map", x=2.0)
    for transforms, passed in (((), []), ((transform,), [pose(-1.0, 1.0, "odom")])):
        transport, host = guarded(
            (GOALS,), (), (KEEP_OUT,), areas=(UNSTABLE,), transforms=transforms
        )
        planner = transport.listen("/rtron/goal/out")
        monitor = transport.publisher("/rtron/goal/aflow3", peer("/monitor", POSE))
        monitor(pose(-1.0, 1.0, "odom"))
        monitor(pose(1.0, 1.0, "odom"))
        assert planner == passed
        tally = host.streams[0].pipeline.tallies["aflow3"]
        assert tally.last.error is (not transforms)


@pytest.mark.parametrize("bad", [pose(float("nan"), 1.0), pose(1.0, 1.0)[:-3], b"", pose(1, 1, "")])
def test_a_goal_that_cannot_be_judged_is_blocked(bad):
    transport, _ = guarded((GOALS,), (), (KEEP_OUT,), areas=(UNSTABLE,))
    planner = transport.listen("/rtron/goal/out")
    transport.publisher("/rtron/goal/aflow3", peer("/monitor", POSE))(bad)
    assert planner == []


def test_another_version_of_the_action_s_type_is_refused():
    transport, _ = guarded((GOALS,), (), (KEEP_OUT,), areas=(UNSTABLE,))
    planner = transport.listen("/rtron/goal/out")
    info = replace(POSE, md5sum="another")
    transport.publisher("/rtron/goal/aflow3", peer("/monitor", info))(pose(1.0, 1.0))
    assert planner == []


def test_an_obligation_blocks_until_what_it_requires_was_seen_and_does_so_each_time():
    danger = replace(LIGHT, when="event.data == 'danger'", name="danger")
    alert = MissionRule(name="alert", when="danger", block=("/cmd_vel",), require="/alert")
    transport, host = guarded((MOVING, ALERTS), (danger,), (alert,))
    driver = transport.listen(OUT)
    nav, lamp = transport.publisher(NAV, peer("/nav")), light(transport)
    voice = transport.publisher("/rtron/alert/aflow4", peer("/voice", STRING))
    for _ in range(2):
        lamp(string("danger"))
        before = len(driver)
        nav(twist(1.0))
        assert all(x < 1.0 for x, _ in speeds(driver[before:]))
        assert any("/alert must follow" in status.message for status in host.statuses())
        voice(string("help"))
        nav(twist(1.0))
        assert speeds(driver)[-1] == (1.0, 0.0)
        lamp(string("fine"))


def test_what_a_later_stage_drops_meets_no_obligation():
    slow = GuardedTopic(
        topic="/slow",
        type="geometry_msgs/Twist",
        flows=(Flow(name="aflow5", publisher="/nav"),),
        successors=("/driver",),
    )
    alert = MissionRule(name="alert", when="red", block=("/cmd_vel",), require="/slow")
    rsrcn = RSRCN(
        id="rsrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.CONSTRAIN,
        max_vel_limit=1.0,
        vflows=(replace(slow, flows=(Flow(name="vflow1", publisher="/nav"),)),),
    )
    transport, _ = guarded((MOVING, slow), rules=(alert,), rsrcn=rsrcn)
    driver = transport.listen(OUT)
    light(transport)(string("red"))
    moving = transport.publisher(NAV, peer("/nav"))
    slowly = transport.publisher("/rtron/slow/aflow5", peer("/nav"))
    slowly(twist(float("nan")))
    moving(twist(0.1))
    slowly(twist(0.2))
    moving(twist(0.3))
    assert [x for x, _ in speeds(driver)] == [0.3]


def test_an_obligation_may_be_met_by_an_event():
    danger = replace(LIGHT, when="event.data == 'danger'", name="danger")
    called = replace(LIGHT, topic="/phone", when="event.data == 'called'", name="called")
    alert = MissionRule(name="alert", when="danger", block=("/cmd_vel",), require="called")
    transport, _ = guarded((MOVING,), (danger, called), (alert,))
    driver = transport.listen(OUT)
    nav, lamp = transport.publisher(NAV, peer("/nav")), light(transport)
    phone = transport.publisher("/phone", peer("/camera", STRING))
    phone(string("called"))
    lamp(string("danger"))
    nav(twist(0.1))
    phone(string("engaged"))
    nav(twist(0.2))
    phone(string("called"))
    nav(twist(0.3))
    assert [x for x, _ in speeds(driver)] == [0.3]


def test_a_rule_blocks_the_flow_that_it_names_and_no_other():
    transport, _ = guarded(rules=(replace(AT_RED, block=("aflow2",)),))
    driver = transport.listen(OUT)
    light(transport)(string("red"))
    transport.publisher("/rtron/cmd_vel/aflow2", peer("/teleop"))(twist(9.0))
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    assert [x for x, _ in speeds(driver)] == [1.0]


def test_the_most_restrictive_rule_wins():
    green = replace(LIGHT, name="green", when="event.data == 'green'")
    free = MissionRule(name="none", when="green && red", block=("/cmd_vel",))
    transport, _ = guarded(eflows=(LIGHT, green), rules=(free, AT_RED))
    driver = transport.listen(OUT)
    light(transport)(string("red"))
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    assert driver == []


def test_presence_and_silence_of_an_event():
    near = replace(LIGHT, name="near", when="", present=SECOND)
    quiet = replace(LIGHT, name="quiet", when="", silent=3 * SECOND)
    rules = (MissionRule(name="near", when="near || quiet", block=("/cmd_vel",)),)
    transport, _ = guarded(eflows=(near, quiet), rules=rules)
    driver = transport.listen(OUT)
    nav, lamp = transport.publisher(NAV, peer("/nav")), light(transport)
    nav(twist(0.1))
    lamp(string(""))
    nav(twist(0.2))
    transport.advance(SECOND)
    nav(twist(0.3))
    transport.advance(2 * SECOND)
    nav(twist(0.4))
    assert 0.3 in [x for x, _ in speeds(driver)]
    assert not {0.1, 0.2, 0.4} & {x for x, _ in speeds(driver)}


def test_each_event_is_decoded_once_however_many_rules_use_it(monkeypatch):
    flows = [replace(LIGHT, name=f"red{n}", when=f"event.data == '{n % 3}'") for n in range(9)]
    rules = [MissionRule(name=f"r{n}", when=f"red{n}", block=("/cmd_vel",)) for n in range(9)]
    transport, host = guarded(eflows=flows, rules=rules)
    (source,) = host.observations.events
    assert len(source.bits) == 9
    light(transport)(string("1"))
    known = host.observations.mission.bits.known_values(transport.now())
    assert [name for name, bit in known.items() if bit] == ["red1", "red4", "red7"]


def test_events_of_a_guarded_publisher_are_heard_on_its_private_topic():
    talk = GuardedTopic(
        topic="/alert",
        type="std_msgs/String",
        flows=(Flow(name="aflow4", publisher="/voice"),),
        successors=("/speaker",),
    )
    spoken = replace(LIGHT, topic="/alert", publisher="/voice", name="spoken")
    transport, _ = guarded((MOVING, talk), (spoken,), (replace(AT_RED, when="spoken"),))
    driver = transport.listen(OUT)
    transport.publisher("/rtron/alert/aflow4", peer("/voice", STRING))(string("green"))
    transport.publisher(NAV, peer("/nav"))(twist(1.0))
    assert len(driver) == 1


def test_a_twist_may_be_judged_by_its_own_fields():
    slow = MissionRule(
        name="forward", when="red", action="action.linear.x > 0.0", block=("/cmd_vel",)
    )
    transport, _ = guarded(rules=(slow,))
    driver = transport.listen(OUT)
    light(transport)(string("red"))
    nav = transport.publisher(NAV, peer("/nav", TWIST))
    nav(twist(1.0))
    nav(twist(-1.0))
    nav(twist(float("nan")))
    assert max(x for x, _ in speeds(driver)) < 0.0


def test_a_flow_that_a_rule_blocks_does_not_take_the_output_from_others():
    grcn = GRCN(
        id="grcn_cmd_vel",
        topic="/cmd_vel",
        type="geometry_msgs/Twist",
        domain=Domain.CONTROL,
        kind=StreamKind.COMMAND,
        sharing=Sharing.CONTEND,
        mode=Mode.ENFORCE,
        policy=PolicyName.PREEMPTION,
        flows=(
            Flow(name="flow1", publisher="/nav", priority=2),
            Flow(name="flow2", publisher="/teleop", priority=1),
        ),
        successors=("/driver",),
    )
    transport, _ = guarded(rules=(replace(AT_RED, block=("aflow1",)),), grcn=(grcn,))
    driver = transport.listen(OUT)
    lamp = light(transport)
    nav = transport.publisher("/rtron/cmd_vel/flow1", peer("/nav"))
    teleop = transport.publisher("/rtron/cmd_vel/flow2", peer("/teleop"))
    lamp(string("red"))
    nav(twist(1.0))
    teleop(twist(0.2))
    lamp(string("green"))
    nav(twist(0.9))
    teleop(twist(0.3))
    assert [x for x, _ in speeds(driver)] == [0.2, 0.9]


def test_a_goal_that_a_rule_forbids_takes_no_place_in_a_queue():
    grcn = GRCN(
        id="grcn_goal",
        topic="/goal",
        type="geometry_msgs/PoseStamped",
        domain=Domain.PLANNING,
        kind=StreamKind.ACTION,
        sharing=Sharing.CONTEND,
        mode=Mode.ENFORCE,
        policy=PolicyName.FIFO_QUEUE,
        flows=(Flow(name="flow1", publisher="/monitor"), Flow(name="flow2", publisher="/rviz")),
        successors=("/move_base",),
    )
    goals = replace(GOALS, flows=(*GOALS.flows, Flow(name="aflow4", publisher="/rviz")))
    transport, _ = guarded((goals,), (), (KEEP_OUT,), areas=(UNSTABLE,), grcn=(grcn,))
    planner = transport.listen("/rtron/goal/out")
    transport.publisher("/rtron/goal/flow1", peer("/monitor", POSE))(pose(3.0, 1.0))
    transport.publisher("/rtron/goal/flow2", peer("/rviz", POSE))(pose(1.0, 1.0))
    assert planner == [pose(1.0, 1.0)]


def test_an_obligation_outlasts_what_it_came_from():
    alert = MissionRule(name="alert", when="red", block=("/cmd_vel",), require="/alert")
    transport, _ = guarded((MOVING, ALERTS), rules=(alert,))
    driver = transport.listen(OUT)
    nav, lamp = transport.publisher(NAV, peer("/nav")), light(transport)
    lamp(string("red"))
    lamp(string("green"))
    nav(twist(0.1))
    assert driver == []
    transport.publisher("/rtron/alert/aflow4", peer("/voice", STRING))(string("help"))
    nav(twist(0.2))
    assert [x for x, _ in speeds(driver)] == [0.2]


def test_two_publishers_of_one_event_are_one_too_many():
    pattern = replace(LIGHT, publisher="/camera_*")
    transport, _ = guarded(eflows=(pattern,))
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    left, right = peer("/camera_left", STRING), peer("/camera_right", STRING)
    transport.publisher("/light", left)(string("green"))
    nav(twist(0.1))
    transport.publisher("/light", right)(string("green"))
    nav(twist(0.2))
    transport.leave("/light", right)
    nav(twist(0.3))
    assert 0.2 not in [x for x, _ in speeds(driver)]
    assert {0.1, 0.3} <= {x for x, _ in speeds(driver)}


def test_an_event_that_is_repeated_grows_old():
    near = replace(
        LIGHT,
        name="near",
        topic="/pose",
        type="geometry_msgs/PoseStamped",
        when="event.pose.position.x > 9.0",
        max_age=SECOND,
    )
    transport, _ = guarded(eflows=(near,), rules=(replace(AT_RED, when="near"),))
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    where = transport.publisher("/pose", peer("/camera", POSE))
    stamped = pose(1.0, 1.0)[:8] + struct.pack("<II", 7, 0) + pose(1.0, 1.0)[16:]
    for _ in range(5):
        where(stamped)
        transport.advance(SECOND // 5)
    nav(twist(0.1))
    assert driver == []
    where(pose(1.0, 1.0))
    nav(twist(0.2))
    assert [x for x, _ in speeds(driver)] == [0.2]


def test_an_event_that_is_too_long_to_look_into_blocks():
    transport, _ = guarded()
    driver = transport.listen(OUT)
    lamp = light(transport)
    lamp(string("green"))
    lamp(string("green" + " " * MAX_EVENT))
    transport.publisher(NAV, peer("/nav"))(twist(0.1))
    assert driver == []
