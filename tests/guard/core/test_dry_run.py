"""A dry run: everything passes, and what would have become of it is counted and told."""

import pytest
from streams import peer, stage, stream
from test_mission_stream import AT_RED, LIGHT, MOVING, light, string
from velocity_messages import speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.observations import observations_of
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.vocabulary import MSRCN, SECOND, Mode, Plan, PolicyName, StreamKind, build_streams

OUT, NAV, TELEOP = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2"


def dry(*wanted):
    transport = MemoryTransport()
    host = Coordinator(transport, wanted, dry_run=True)
    host.open()
    return transport, host, transport.listen(OUT)


def test_what_would_be_dropped_passes_and_is_counted():
    transport, host, driver = dry(stream())
    messages = [twist(x) for x in (1.0, 2.0, 3.0)]
    sides = ((NAV, "/nav"), (TELEOP, "/teleop"), ("/cmd_vel", "/rogue"))
    for (topic, node), message in zip(sides, messages, strict=True):
        transport.publisher(topic, peer(node))(message)
    assert driver == messages
    tallies = host.streams[0].pipeline.tallies
    assert [tallies[flow].passed for flow in ("flow1", "flow2", "unapproved")] == [1, 0, 0]
    assert [tallies[flow].dropped for flow in ("flow1", "flow2", "unapproved")] == [0, 1, 1]


def test_what_a_stranger_says_passes_only_in_the_type_that_the_approved_have():
    transport, _, driver = dry(stream())
    transport.publisher("/cmd_vel", peer("/early"))(twist(1.0))
    transport.publisher(NAV, peer("/nav"))(twist(2.0))
    transport.publisher("/cmd_vel", peer("/liar", TypeInfo("std_msgs/String", "x")))(b"bad")
    transport.publisher("/cmd_vel", peer("/rogue"))(twist(3.0))
    assert [x for x, _ in speeds(driver)] == [2.0, 3.0]


@pytest.mark.parametrize("kind", [StreamKind.COMMAND, StreamKind.ACTION])
def test_what_would_wait_passes_once_and_at_once(kind):
    queue = stage(policy=PolicyName.FIFO_QUEUE, kind=kind)
    transport, host, driver = dry(stream(queue))
    nav = transport.publisher(NAV, peer("/nav"))
    teleop = transport.publisher(TELEOP, peer("/teleop"))
    nav(twist(1.0))
    teleop(twist(2.0))
    assert [x for x, _ in speeds(driver)] == [1.0, 2.0]
    transport.advance(700 * SECOND)
    assert [x for x, _ in speeds(driver)] == [1.0, 2.0]
    assert host.streams[0].pipeline.tallies["flow2"].held == 1


def test_a_rule_that_holds_stops_nothing_and_is_told():
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(MOVING,),
        eflows=(LIGHT,),
        rules=(AT_RED,),
    )
    plan = Plan(app="test", msrcn=msrcn)
    transport = MemoryTransport()
    host = Coordinator(transport, build_streams(plan), observations_of(plan), dry_run=True)
    host.open()
    driver = transport.listen(OUT)
    lamp = light(transport)
    nav = transport.publisher("/rtron/cmd_vel/aflow1", peer("/nav"))
    lamp(string("green"))
    nav(twist(1.0))
    lamp(string("red"))
    nav(twist(1.0))
    transport.advance(SECOND)
    assert [x for x, _ in speeds(driver)] == [1.0, 1.0]
    assert host.streams[0].stop_controller.stop_count == 1
    assert host.streams[0].pipeline.tallies["aflow1"].dropped == 1
    told = host.statuses()[0]
    assert told.message.startswith("dry run, everything passes")
