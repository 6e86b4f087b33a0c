"""What the guard says itself and what it makes of velocities is CDR where the transport's is."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from message_samples import ENCODINGS, ROS1, ROS2, encode, header, long_name, make, pose_stamped

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import observations_of
from rtron.guard.core.report_messages import (
    DIAGNOSTICS,
    FLOAT64,
    STRING,
    Status,
    diagnostics_message,
    float64_message,
    string_message,
)
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.messages import DefinitionRegistry, Encoding, parse_definition
from rtron.messages.ros2.cdr_validator import cdr_validator
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    PolicyName,
    build_streams,
)

STANDARD = {Encoding.ROS1: DefinitionRegistry(), Encoding.CDR: DefinitionRegistry(ros=2)}
CDR = Encoding.CDR
NAV, OUT = "/rtron/cmd_vel/vflow1", "/rtron/cmd_vel/out"
TEXTS = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=20)


def decoded(encoding, type, message):
    """Return what rosbags reads."""
    if encoding is CDR:
        return ROS2.deserialize_cdr(message, long_name(type))
    return ROS1.deserialize_ros1(message[4:], long_name(type))


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("info", ["string", "float64", "diagnostics"])
def test_types_are_the_standard_ones(encoding, info):
    known = {"string": STRING, "float64": FLOAT64, "diagnostics": DIAGNOSTICS[encoding]}[info]
    assert parse_definition(known.type, known.definition).md5sum == known.md5sum
    assert STANDARD[encoding].find(known.type).md5sum == known.md5sum


@pytest.mark.parametrize("encoding", ENCODINGS)
@given(text=TEXTS, number=st.floats(allow_nan=False))
def test_strings_and_numbers(encoding, text, number):
    assert decoded(encoding, STRING.type, string_message(encoding, text)).data == text
    assert decoded(encoding, FLOAT64.type, float64_message(encoding, number)).data == number


@pytest.mark.parametrize("encoding", ENCODINGS)
@given(
    statuses=st.lists(
        st.builds(
            Status,
            level=st.integers(0, 3),
            name=TEXTS,
            message=TEXTS,
            values=st.dictionaries(TEXTS, TEXTS, max_size=3),
        ),
        max_size=4,
    )
)
def test_diagnostics(encoding, statuses):
    message = diagnostics_message(encoding, 7, 3 * SECOND + 5, statuses)
    found = decoded(encoding, "diagnostic_msgs/DiagnosticArray", message)
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (3, 5)
    assert len(found.status) == len(statuses)
    for one, other in zip(found.status, statuses, strict=True):
        assert (one.level, one.name, one.message) == (other.level, other.name, other.message)
        assert {each.key: each.value for each in one.values} == other.values


@pytest.mark.parametrize("encoding", Encoding)
def test_a_clock_before_1970_keeps_no_diagnostics_back(encoding):
    message = diagnostics_message(encoding, 7, 5 - 2 * SECOND, [])
    stamp = decoded(encoding, "diagnostic_msgs/DiagnosticArray", message).header.stamp
    assert (stamp.sec, stamp.nanosec) == (-2, 5)


def test_what_ends_a_string_is_not_in_it():
    message = string_message(CDR, "a\0b\ud800")
    cdr_validator(STANDARD[CDR].find(STRING.type))(message)
    assert decoded(CDR, STRING.type, message).data == "a?b?"


def test_a_type_without_fields_has_a_definition_too():
    info = standard_info("std_msgs/Empty", Encoding.ROS1)
    assert info is not None
    assert info.definition == ""


MOVING = GuardedTopic(
    topic="/cmd_vel",
    type="geometry_msgs/msg/Twist",
    flows=(Flow(name="vflow1", publisher="/nav", silent_after=SECOND // 4),),
    successors=("/driver",),
)
GOALS = GuardedTopic(
    topic="/goal",
    type="geometry_msgs/msg/PoseStamped",
    flows=(Flow(name="aflow1", publisher="/planner"),),
    successors=("/nav",),
)
LIGHT = EventFlow(
    name="red",
    topic="/light",
    publisher="/camera",
    type="std_msgs/msg/String",
    when="event.data == 'red'",
)
AT_RED = MissionRule(name="red_light", when="red", block=("/goal",), reason="the light is red")
KEEP_OUT = MissionRule(
    name="keep_out", action="action.pose.position.x > 2.0", block=("/goal",), reason="too far"
)
MONITOR = FpsMonitor(id="fps_cam", node="/detector", topic="/image")


def guarded(**parts):
    plan = Plan(app="test", ros=2, **parts)
    transport = MemoryTransport(CDR)
    host = Coordinator(transport, build_streams(plan), observations_of(plan))
    host.open()
    return transport, host


def rsrcn(policy=PolicyName.CONSTRAIN, **limits):
    return RSRCN(id="rsrcn", mode=Mode.ENFORCE, policy=policy, vflows=(MOVING,), **limits)


def publisher(transport, topic, node, type):
    return transport.publisher(topic, Peer(node, standard_info(type, CDR)))


def twist(speed):
    return CDR.prefix(48) + struct.pack("<6d", speed, 0, 0, 0, 0, 0)


def speeds(messages):
    return [decoded(CDR, "geometry_msgs/Twist", each).linear.x for each in messages]


def test_a_velocity_is_limited_and_stopped_and_the_guard_says_so():
    transport, _ = guarded(rsrcn=rsrcn(max_vel_limit=0.5))
    driver, active = transport.listen(OUT), transport.listen("/rtron/rsrcn/cmd_vel/active")
    publisher(transport, NAV, "/nav", "geometry_msgs/Twist")(twist(2.0))
    assert speeds(driver) == [0.5]
    transport.advance(3 * SECOND)
    assert speeds(driver)[-1] == 0.0
    told = [decoded(CDR, STRING.type, each).data for each in active]
    assert any("stopping: vflow1 has been silent" in each for each in told)
    assert told[-1] == "idle"


def test_the_robot_is_kept_stopped_before_anybody_has_told_the_type():
    transport, host = guarded(rsrcn=rsrcn(max_vel_limit=0.5))
    driver = transport.listen(OUT)
    host.streams[0].brake("test", "a test")
    assert set(speeds(driver)) == {0.0}


def test_states_are_told_once_a_second():
    transport, _ = guarded(rsrcn=rsrcn(max_vel_limit=0.5))
    heard = transport.listen("/diagnostics")
    transport.advance(2 * SECOND)
    assert len(heard) == 2
    found = [decoded(CDR, "diagnostic_msgs/DiagnosticArray", each) for each in heard]
    assert all(each.status[0].hardware_id == "rtron" for each in found)
    assert transport.outputs["/diagnostics"].info == DIAGNOSTICS[CDR]


def test_frame_rates_limit_velocities_and_are_told():
    transport, _ = guarded(rsrcn=rsrcn(PolicyName.SAFE, threshold=0.05), fps_monitor=(MONITOR,))
    driver, told = transport.listen(OUT), transport.listen("/rtron/fps_cam/fps")
    camera = publisher(transport, "/image", "/detector", "sensor_msgs/Image")
    for frame in range(20):
        transport.advance(SECOND // 20)
        camera(image(seconds=frame + 1))
    publisher(transport, NAV, "/nav", "geometry_msgs/Twist")(twist(2.0))
    assert speeds(driver) == pytest.approx([1.0])
    assert decoded(CDR, FLOAT64.type, told[-1]).data == pytest.approx(20.0, abs=2.0)


def image(seconds):
    made = make(CDR, "sensor_msgs/Image", header(CDR, "cam", seconds), 1, 1, "rgb8", 0, 3, PIXEL)
    return encode(CDR, "sensor_msgs/Image", made)


PIXEL = np.zeros(3, dtype=np.uint8)


def test_rules_look_into_events_and_goals():
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(GOALS,),
        eflows=(LIGHT,),
        rules=(AT_RED, KEEP_OUT),
    )
    transport, host = guarded(msrcn=msrcn)
    heard = transport.listen("/rtron/goal/out")
    ask = publisher(transport, "/rtron/goal/aflow1", "/planner", "geometry_msgs/PoseStamped")
    lamp = publisher(transport, "/light", "/camera", "std_msgs/String")
    near, far = pose_stamped(CDR, x=1.0), pose_stamped(CDR, x=3.0)
    lamp(string_message(CDR, "green"))
    ask(far)
    ask(near)
    lamp(string_message(CDR, "red"))
    ask(near)
    assert heard == [near]
    assert host.streams[0].pipeline.tallies["aflow1"].dropped == 2
