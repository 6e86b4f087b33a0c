"""No policy lets through what is no number, or what the base does not obey."""

import math
import struct
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from message_samples import encode, header, make
from streams import FLOWS, WORDS, peer, stage, stream
from velocity_messages import speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import codec_of, number_checker, standard_info
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages import DefinitionRegistry, Encoding
from rtron.messages.common.finite_numbers import NUMERIC_COMMAND_TYPES
from rtron.messages.common.layout import zero_body_size
from rtron.messages.common.velocity import VELOCITY_TYPES
from rtron.vocabulary import (
    MSRCN,
    SECOND,
    TWIST_COMPONENTS,
    CoordinationKind,
    Flow,
    GuardedTopic,
    Mode,
    OnError,
    Plan,
    PolicyName,
    StreamKind,
    Velocity,
    build_streams,
)

NAV, OUT = "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/out"
OF_GRCN = (
    PolicyName.BLOCK,
    PolicyName.PREEMPTION,
    PolicyName.FIFO_QUEUE,
    PolicyName.PRIORITY_QUEUE,
)
QUIET = tuple(replace(flow, on_error=OnError.DROP) for flow in FLOWS)
NO_NUMBERS = (math.nan, -math.nan, math.inf, -math.inf)
STANDARD = {Encoding.ROS1: DefinitionRegistry(), Encoding.CDR: DefinitionRegistry(ros=2)}
FLOATS = {
    "geometry_msgs/Twist": "6d",
    "geometry_msgs/TwistStamped": "6d",
    "ackermann_msgs/AckermannDrive": "5f",
    "ackermann_msgs/AckermannDriveStamped": "5f",
    "std_msgs/Float64": "1d",
    "std_msgs/Float32": "1f",
}
EACH_FLOAT = [(type, at) for type, code in FLOATS.items() for at in range(int(code[0]))]


def info_of(type, encoding=Encoding.ROS1):
    known = standard_info(type, encoding)
    return known or TypeInfo(type, STANDARD[encoding].find(type).md5sum)


TWIST = info_of("geometry_msgs/Twist")


def message_of(type, encoding, values):
    """Return a message of a velocity type with these floats."""
    codec = codec_of(info_of(type, encoding), encoding)
    zeros = codec.zero_message
    packed = struct.pack(f"<{FLOATS[type]}", *values)
    at = codec._find(zeros)
    return zeros[:at] + packed + zeros[at + len(packed) :]


def guarded(type="geometry_msgs/Twist", policy=PolicyName.BLOCK, encoding=Encoding.ROS1, **more):
    """Guard /cmd_vel by a GRCN alone; return the transport, navigation, driver and the stream."""
    transport = MemoryTransport(encoding)
    flows = more.pop("flows", FLOWS)
    wanted = stream(stage(policy=policy, flows=flows), type=type, flows=flows, **more)
    host = Coordinator(transport, (wanted,))
    host.open()
    driver = transport.listen(OUT) if OUT in transport.outputs else []
    topic = NAV if wanted.mode is Mode.ENFORCE else "/cmd_vel"
    nav = transport.publisher(topic, peer("/nav", info_of(type, encoding)))
    return transport, nav, driver, host.streams[0]


def test_every_type_of_velocity_is_checked():
    assert FLOATS.keys() == VELOCITY_TYPES


@pytest.mark.parametrize("encoding", Encoding)
@pytest.mark.parametrize("policy", OF_GRCN)
@pytest.mark.parametrize(("type", "at"), EACH_FLOAT)
def test_what_is_no_number_never_goes_out_under_any_policy(type, at, policy, encoding):
    transport, nav, driver, guarded_stream = guarded(type, policy, encoding, flows=QUIET)
    good = message_of(type, encoding, [0.25] * int(FLOATS[type][0]))
    nav(good)
    for bad in NO_NUMBERS:
        values = [0.25] * int(FLOATS[type][0])
        values[at] = bad
        nav(message_of(type, encoding, values))
        transport.advance(SECOND)
    assert driver == [good]
    tally = guarded_stream.pipeline.tallies["flow1"]
    assert (tally.passed, tally.dropped) == (1, len(NO_NUMBERS))
    assert (tally.last.reason, tally.last.error) == ("NaN or Inf is no velocity", True)


@pytest.mark.parametrize("bad", [b"", b"\x00", twist(1.0)[:-1], twist(1.0) + b"\x00"])
@pytest.mark.parametrize("policy", OF_GRCN)
def test_what_is_no_velocity_never_goes_out_either(policy, bad):
    _, nav, driver, guarded_stream = guarded(policy=policy)
    nav(bad)
    assert driver == []
    assert guarded_stream.pipeline.tallies["flow1"].last.error


def test_a_velocity_whose_definition_nobody_knows_never_goes_out():
    transport = MemoryTransport()
    host = Coordinator(transport, (stream(type=""),))
    host.open()
    driver = transport.listen(OUT)
    strange = TypeInfo("geometry_msgs/Twist", "0" * 32, "float64 other")
    transport.publisher(NAV, peer("/nav", strange))(twist(1.0))
    assert driver == []
    reason = host.streams[0].pipeline.tallies["flow1"].last.reason
    assert reason == "messages of this type hold no velocity that is known"


def guarded_by_mission(mode=Mode.ENFORCE):
    transport = MemoryTransport()
    flow = Flow(name="flow1", publisher="/nav")
    topic = GuardedTopic(topic="/cmd_vel", type="geometry_msgs/Twist", flows=(flow,))
    msrcn = MSRCN(id="msrcn", mode=mode, policy=PolicyName.BLOCK, aflows=(topic,))
    host = Coordinator(transport, build_streams(Plan(app="base", msrcn=msrcn)))
    host.open()
    return transport, host.streams[0]


def test_a_mission_alone_lets_no_nan_through():
    transport, _ = guarded_by_mission()
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    nav(twist(0.5))
    nav(twist(math.nan))
    transport.advance(5 * SECOND)
    sent = [x for x, _ in speeds(driver)]
    assert sent[0] == 0.5
    assert all(one > other or one == other == 0 for one, other in pairwise(sent))


def test_who_only_watches_tells_it():
    transport, watched = guarded_by_mission(Mode.OBSERVE)
    transport.publisher("/cmd_vel", peer("/nav"))(twist(math.inf))
    assert watched.pipeline.tallies["flow1"].last.error


@pytest.mark.parametrize(("on_error", "stops"), [(OnError.STOP, 1), (OnError.DROP, 0)])
def test_it_stops_the_robot_where_the_plan_says_so(on_error, stops):
    flows = (replace(FLOWS[0], on_error=on_error),)
    transport, nav, _, guarded_stream = guarded(flows=flows)
    nav(twist(1.0))
    nav(twist(math.nan))
    transport.advance(0)
    assert guarded_stream.stop_controller.stop_count == stops


def test_it_does_not_keep_the_output_from_others():
    transport, nav, driver, _ = guarded(policy=PolicyName.PREEMPTION)
    teleop = transport.publisher("/rtron/cmd_vel/flow2", peer("/teleop", TWIST))
    nav(twist(math.nan))
    teleop(twist(0.5))
    assert driver == [twist(0.5)]


def test_a_stranger_is_unapproved_whatever_it_says():
    transport, _, _, guarded_stream = guarded()
    transport.publisher("/cmd_vel", peer("/rogue"))(twist(math.nan))
    last = guarded_stream.pipeline.tallies["unapproved"].last
    assert (last.reason, last.error) == ("unapproved is not an approved flow", False)


def test_a_stranger_that_the_plan_lets_through_is_checked():
    transport, _, driver, _ = guarded(policy=PolicyName.PREEMPTION, block_unapproved=False)
    rogue = transport.publisher("/cmd_vel", peer("/rogue", TWIST))
    rogue(twist(math.nan))
    rogue(twist(0.5))
    assert driver == [twist(0.5)]


def test_states_and_what_holds_no_velocity_are_not_looked_into():
    transport = MemoryTransport()
    state = stage(policy=PolicyName.BLOCK, kind=StreamKind.STATE)
    words = stream(topic="/words", type=WORDS.type)
    Coordinator(transport, (stream(state), words)).open()
    measured, heard = transport.listen(OUT), transport.listen("/rtron/words/out")
    transport.publisher(NAV, peer("/nav"))(twist(math.nan))
    transport.publisher("/rtron/words/flow1", peer("/nav", WORDS))(b"\xff\xff")
    assert len(measured) == len(heard) == 1


def test_a_verdict_tells_the_revision_of_the_settings():
    _, nav, _, guarded_stream = guarded()
    guarded_stream.pipeline.revise(7)
    nav(twist(math.nan))
    assert guarded_stream.pipeline.tallies["flow1"].last.revision == 7


# What the base uses


def six(message):
    return struct.unpack("<I6d", message)[1:]


def test_what_the_base_does_not_use_is_set_to_0():
    _, nav, driver, guarded_stream = guarded(uses=("linear.x", "angular.z"))
    nav(struct.pack("<I6d", 48, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    nav(twist(0.5, turn=1.0))
    assert [six(each) for each in driver] == [(1.0, 0, 0, 0, 0, 6.0), (0.5, 0, 0, 0, 0, 1.0)]
    tally = guarded_stream.pipeline.tallies["flow1"]
    assert (tally.modified, tally.passed) == (1, 1)


def test_the_reason_names_what_is_not_used():
    _, nav, _, guarded_stream = guarded(uses=TWIST_COMPONENTS[:5])
    nav(twist(0.5, turn=1.0))
    reason = guarded_stream.pipeline.tallies["flow1"].last.reason
    assert reason == "the base does not use angular.z"


@pytest.mark.parametrize("type", ["geometry_msgs/Twist", "geometry_msgs/TwistStamped"])
@given(
    values=st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=6, max_size=6),
    used=st.sets(st.sampled_from(TWIST_COMPONENTS), min_size=1),
    encoding=st.sampled_from(Encoding),
)
def test_each_component_is_as_it_was_or_0(type, values, used, encoding):
    _, nav, driver, _ = guarded(type, encoding=encoding, uses=tuple(used))
    nav(message_of(type, encoding, values))
    kept = [
        value if name in used else 0.0 for name, value in zip(TWIST_COMPONENTS, values, strict=True)
    ]
    (sent,) = driver
    codec = codec_of(info_of(type, encoding), encoding)
    assert codec.decode(sent) == Velocity(tuple(kept[:3]), tuple(kept[3:]))


def test_without_uses_all_is_as_it_was():
    _, nav, driver, _ = guarded()
    message = struct.pack("<I6d", 48, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    nav(message)
    assert driver[0] is message


def test_a_later_stage_sees_what_is_left():
    limiting = replace(
        stage("rsrcn", PolicyName.CONSTRAIN, max_vel_limit=0.5),
        coordination_kind=CoordinationKind.RSRCN,
    )
    transport = MemoryTransport()
    Coordinator(transport, (stream(stage(), limiting, uses=("linear.x",)),)).open()
    driver = transport.listen(OUT)
    nav = transport.publisher(NAV, peer("/nav"))
    nav(twist(0.4, y=9.0))
    nav(twist(2.0, y=9.0, turn=1.0))
    assert speeds(driver) == [(0.4, 0.0), (0.5, 0.0)]


def test_what_waits_is_what_is_left():
    transport, nav, driver, _ = guarded(policy=PolicyName.PRIORITY_QUEUE, uses=("linear.x",))
    teleop = transport.publisher("/rtron/cmd_vel/flow2", peer("/teleop", TWIST))
    nav(twist(0.5))
    transport.advance(SECOND // 10)
    teleop(twist(0.25, turn=9.0))
    transport.advance(SECOND)
    assert driver == [twist(0.5), twist(0.25)]


@pytest.mark.parametrize(("type", "at"), [each for each in EACH_FLOAT if "Twist" not in each[0]])
def test_uses_means_nothing_where_there_are_no_components(type, at):
    """A plan may leave the type out; what is no Twist has nothing that is not used."""
    _, nav, driver, _ = guarded(type, uses=("linear.x",))
    values = [0.0] * int(FLOATS[type][0])
    values[at] = 0.25
    nav(message_of(type, Encoding.ROS1, values))
    assert driver == [message_of(type, Encoding.ROS1, values)]


def test_what_is_not_used_is_checked_all_the_same():
    _, nav, driver, _ = guarded(uses=("linear.x",))
    for at, bad in product(range(6), NO_NUMBERS):
        values = [0.0] * 6
        values[at] = bad
        nav(struct.pack("<I6d", 48, *values))
    assert driver == []


# Other commands


JOINTS = "trajectory_msgs/JointTrajectory"
ARRAY = "std_msgs/Float64MultiArray"
BAD_POINTS = [
    (field, at, bad)
    for field in ("positions", "velocities", "accelerations", "effort")
    for at in range(3)
    for bad in NO_NUMBERS
]


def point(encoding, **values):
    """Return a point of a trajectory; each list has three numbers or none."""
    names = ("positions", "velocities", "accelerations", "effort")
    lists = [np.array(values.get(name, ()), dtype=np.float64) for name in names]
    return make(encoding, "trajectory_msgs/JointTrajectoryPoint", *lists, duration(encoding))


def duration(encoding):
    return make(encoding, "builtin_interfaces/Duration", 1, 2)


@pytest.fixture
def arm():
    """Guard the commands of an arm by Block."""

    def start(type, encoding):
        transport = MemoryTransport(encoding)
        quiet = stage(policy=PolicyName.BLOCK, flows=QUIET)
        host = Coordinator(transport, (stream(quiet, topic="/arm", type=type, flows=QUIET),))
        host.open()
        say = transport.publisher("/rtron/arm/flow1", peer("/nav", info_of(type, encoding)))
        return say, transport.listen("/rtron/arm/out"), host.streams[0]

    return start


@pytest.mark.parametrize("encoding", Encoding)
def test_no_trajectory_with_nan_goes_out(arm, encoding):
    say, heard, guarded_arm = arm(JOINTS, encoding)
    good = [0.5, -0.5, 1e300]
    head = header(encoding, "map")

    def trajectory(*points):
        return encode(encoding, JOINTS, make(encoding, JOINTS, head, ["a", "bcd"], list(points)))

    first = point(encoding, positions=good, velocities=good)
    say(trajectory(first, first))
    for field, at, bad in BAD_POINTS:
        values = list(good)
        values[at] = bad
        say(trajectory(first, point(encoding, **{field: values})))
    assert heard == [trajectory(first, first)]
    tally = guarded_arm.pipeline.tallies["flow1"]
    assert (tally.passed, tally.dropped) == (1, len(BAD_POINTS))
    assert (tally.last.reason, tally.last.error) == ("no command: NaN or Inf in effort", True)


@pytest.mark.parametrize("encoding", Encoding)
@given(values=st.lists(st.floats(), max_size=9))
def test_an_array_goes_out_if_each_of_its_floats_is_a_number(encoding, values):
    transport = MemoryTransport(encoding)
    Coordinator(transport, (stream(stage(flows=QUIET), type=ARRAY, flows=QUIET),)).open()
    heard = transport.listen(OUT)
    layout = make(encoding, "std_msgs/MultiArrayLayout", [], 0)
    array = make(encoding, ARRAY, layout, np.array(values, dtype=np.float64))
    message = encode(encoding, ARRAY, array)
    transport.publisher(NAV, peer("/nav", info_of(ARRAY, encoding)))(message)
    assert heard == ([message] if all(map(math.isfinite, values)) else [])


@pytest.mark.parametrize("encoding", Encoding)
def test_every_other_type_of_command_that_is_checked_is_known(encoding):
    for type in NUMERIC_COMMAND_TYPES:
        check = number_checker(info_of(type, encoding), encoding)
        size = zero_body_size(STANDARD[encoding].find(type), encoding)
        check(encoding.prefix(size) + bytes(size))


def test_a_command_whose_definition_nobody_knows_never_goes_out(arm):
    say, heard, _ = arm(ARRAY, Encoding.ROS1)
    transport = MemoryTransport()
    host = Coordinator(transport, (stream(type=""),))
    host.open()
    strange = TypeInfo(ARRAY, "0" * 32, "float64 other")
    transport.publisher(NAV, peer("/nav", strange))(b"")
    reason = host.streams[0].pipeline.tallies["flow1"].last.reason
    assert reason == "no command: nobody knows the definition"
    say(b"")
    assert heard == []


def test_a_state_of_floats_is_not_looked_into():
    transport = MemoryTransport()
    state = stage(policy=PolicyName.BLOCK, kind=StreamKind.STATE)
    Coordinator(transport, (stream(state, type=ARRAY),)).open()
    heard = transport.listen(OUT)
    transport.publisher(NAV, peer("/nav", info_of(ARRAY)))(b"any")
    assert heard == [b"any"]
