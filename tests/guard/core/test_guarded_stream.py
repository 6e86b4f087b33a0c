"""One stream from its flows to its successors, on the transport in memory."""

from dataclasses import replace
from functools import partial

import pytest
from streams import FLOWS, TWIST, WORDS, stage
from streams import peer as peer_of
from streams import stream as stream_of
from velocity_messages import twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.vocabulary import (
    SECOND,
    SUPERVISOR_NODE,
    CoordinationKind,
    Flow,
    Mode,
    PolicyName,
    StreamKind,
)

OUT, NAV, TELEOP = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2"
TENTH = SECOND // 10
stream = partial(stream_of, type=WORDS.type)


def peer(node, info=WORDS, **more):
    return peer_of(node, info, **more)


def guarded(*streams):
    transport = MemoryTransport()
    host = Coordinator(transport, streams)
    host.open()
    return transport, host


def guarded_map(*flows):
    """Guard /map, whose last words are kept for late subscribers, with Block."""
    block = stage(policy=PolicyName.BLOCK, flows=flows, kind=StreamKind.STATE)
    return guarded(stream(block, topic="/map", type="", flows=flows))


def test_what_an_approved_publisher_says_reaches_successors_and_tools():
    transport, _ = guarded(stream())
    driver, tool = transport.listen(OUT), transport.listen("/cmd_vel")
    transport.publisher(NAV, peer("/nav"))(b"forward")
    assert driver == tool == [b"forward"]


def test_the_lower_flow_waits_until_the_higher_is_silent():
    transport, _ = guarded(stream())
    driver = transport.listen(OUT)
    nav, teleop = (
        transport.publisher(NAV, peer("/nav")),
        transport.publisher(TELEOP, peer("/teleop")),
    )
    nav(b"n1")
    transport.advance(SECOND // 2 - 1)
    teleop(b"too early")
    transport.advance(1)
    teleop(b"t1")
    nav(b"n2")
    assert driver == [b"n1", b"t1", b"n2"]


def test_the_public_name_is_unapproved_even_for_a_planned_name_and_while_idle():
    transport, host = guarded(stream())
    driver, tool = transport.listen(OUT), transport.listen("/cmd_vel")
    transport.publisher("/cmd_vel", peer("/rogue"))(b"turn right")
    transport.publisher("/cmd_vel", peer("/nav"))(b"turn right")
    assert driver == tool == []
    assert host.streams[0].pipeline.tallies["unapproved"].dropped == 2


@pytest.mark.parametrize(
    ("publisher", "successors", "is_known"),
    [
        (peer(SUPERVISOR_NODE), (), True),
        (peer(SUPERVISOR_NODE, verified=False), (), False),
        (peer(SUPERVISOR_NODE), ("/driver",), True),
        (peer("/rogue"), (), False),
    ],
)
def test_the_supervisor_alone_may_stop_who_listens_to_the_public_name(
    publisher, successors, is_known
):
    transport, host = guarded(stream(successors=successors))
    transport.publisher("/cmd_vel", publisher)
    assert (publisher.node not in host.streams[0].strangers) is is_known


@pytest.mark.parametrize(
    "impostor", [peer("/rogue"), peer("/nav", verified=False), peer("/nav2"), peer("")]
)
def test_a_stranger_on_a_private_topic_is_unapproved(impostor):
    transport, host = guarded(stream())
    driver = transport.listen(OUT)
    transport.publisher(NAV, impostor)(b"turn right")
    assert driver == []
    assert impostor.node in host.streams[0].strangers


def test_a_pattern_names_an_anonymous_publisher():
    flows = (Flow(name="flow1", publisher="/nav_*"),)
    transport, _ = guarded(stream(stage(flows=flows), flows=flows))
    driver = transport.listen(OUT)
    transport.publisher(NAV, peer("/nav_host_12"))(b"n")
    assert driver == [b"n"]


def test_unapproved_goes_last_where_the_plan_lets_it_through():
    transport, _ = guarded(stream(block_unapproved=False))
    driver = transport.listen(OUT)
    rogue, nav = (
        transport.publisher("/cmd_vel", peer("/rogue")),
        transport.publisher(NAV, peer("/nav")),
    )
    rogue(b"r1")
    nav(b"n1")
    rogue(b"r2")
    assert driver == [b"r1", b"n1"]


def test_a_publisher_of_another_type_is_refused():
    transport, _ = guarded(stream())
    driver = transport.listen(OUT)
    transport.publisher(NAV, peer("/nav"))(b"n1")
    transport.publisher(TELEOP, peer("/teleop", TypeInfo("std_msgs/String", "x")))(b"bad")
    transport.publisher(NAV, peer("/nav", replace(WORDS, md5sum="changed")))(b"bad")
    assert driver == [b"n1"]


def test_a_stranger_does_not_set_the_type():
    transport, _ = guarded(stream(type=""))
    driver = transport.listen(OUT)
    transport.publisher("/cmd_vel", peer("/rogue", TypeInfo("x/Y", "z")))(b"bad")
    transport.publisher(NAV, peer("/nav"))(b"n1")
    assert driver == [b"n1"]


def test_latched_state_is_kept_by_publisher_for_late_subscribers():
    transport, _ = guarded_map(
        Flow(name="flow1", publisher="/map_server"), Flow(name="flow2", publisher="/patch")
    )
    first = transport.publisher("/rtron/map/flow1", peer("/map_server", latching=True))
    second = transport.publisher("/rtron/map/flow2", peer("/patch", latching=True))
    first(b"old map")
    first(b"map")
    second(b"patch")
    assert transport.listen("/rtron/map/out") == [b"map", b"patch"]


def test_a_blocked_latched_message_is_not_kept():
    transport, _ = guarded_map(Flow(name="flow1", publisher="/map_server", block=True))
    transport.publisher("/rtron/map/flow1", peer("/map_server", latching=True))(b"map")
    assert transport.listen("/rtron/map/out") == []


def test_a_node_that_publishes_and_subscribes_hears_the_others_but_not_itself():
    transport, _ = guarded(stream(successors=("/driver", "/nav")))
    on_private_name, driver = transport.listen(NAV), transport.listen(OUT)
    nav, teleop = (
        transport.publisher(NAV, peer("/nav")),
        transport.publisher(TELEOP, peer("/teleop")),
    )
    teleop(b"t1")
    nav(b"n1")
    assert on_private_name == [b"t1"]
    assert driver == [b"t1", b"n1"]


def test_observing_lets_nothing_in_or_out_of_the_way():
    transport, host = guarded(stream(mode=Mode.OBSERVE))
    for node in ("/nav", "/teleop", "/rogue"):
        transport.publisher("/cmd_vel", peer(node))(b"m")
    assert [t for t in transport.outputs if "cmd_vel" in t and "active" not in t] == []
    tallies = host.streams[0].pipeline.tallies
    assert (tallies["flow1"].passed, tallies["flow2"].dropped) == (1, 1)
    assert tallies["unapproved"].dropped == 1


def test_a_second_stage_has_its_say_and_sees_what_the_first_releases():
    limiting = stage("rsrcn", PolicyName.CONSTRAIN, max_vel_limit=0.5)
    limiting = replace(limiting, coordination_kind=CoordinationKind.RSRCN)
    first = stage(policy=PolicyName.PRIORITY_QUEUE)
    transport, host = guarded(stream(first, limiting, type=TWIST.type))
    driver, joint = transport.listen(OUT), transport.listen("/rtron/cmd_vel/grcn_cmd_vel")
    nav, teleop = (
        transport.publisher(NAV, peer("/nav", TWIST)),
        transport.publisher(TELEOP, peer("/teleop", TWIST)),
    )
    nav(twist(0.25))
    transport.advance(TENTH)
    teleop(twist(2.0))
    assert driver == [twist(0.25)]
    transport.advance(SECOND)
    assert driver == joint == [twist(0.25), twist(0.5)]
    tallies = host.streams[0].pipeline.tallies
    assert (tallies["flow1"].passed, tallies["flow2"].modified) == (1, 1)


def test_what_a_later_stage_blocks_is_not_put_to_the_first():
    blocking = stage("msrcn", PolicyName.BLOCK, (replace(FLOWS[0], block=True), FLOWS[1]))
    transport, host = guarded(stream(stage(policy=PolicyName.PRIORITY_QUEUE), blocking))
    driver = transport.listen(OUT)
    nav, teleop = (
        transport.publisher(NAV, peer("/nav")),
        transport.publisher(TELEOP, peer("/teleop")),
    )
    nav(b"n1")
    teleop(b"t1")
    assert driver == [b"t1"]
    assert host.streams[0].pipeline.tallies["flow1"].dropped == 1


def test_the_next_goal_goes_when_a_successor_says_done():
    queue = stage(policy=PolicyName.FIFO_QUEUE, kind=StreamKind.ACTION, max_age=60 * SECOND)
    transport, _ = guarded(stream(queue, type="", done="/result"))
    driver = transport.listen(OUT)
    nav, teleop = (
        transport.publisher(NAV, peer("/nav")),
        transport.publisher(TELEOP, peer("/teleop")),
    )
    nav(b"goal 1")
    teleop(b"goal 2")
    transport.publisher("/result", peer("/rogue"))(b"done")
    transport.publisher("/result", peer("/driver", verified=False))(b"done")
    assert driver == [b"goal 1"]
    transport.publisher("/result", peer("/driver"))(b"done")
    assert driver == [b"goal 1", b"goal 2"]


def test_who_is_in_control_is_latched_and_falls_back_to_idle():
    transport, _ = guarded(stream())
    topic = "/rtron/grcn_cmd_vel/cmd_vel/active"
    assert transport.listen(topic)[0].endswith(b"idle")
    transport.publisher(NAV, peer("/nav"))(b"n")
    assert transport.listen(topic)[0].endswith(b"flow1 /nav")
    transport.advance(SECOND // 2)
    assert transport.listen(topic)[0].endswith(b"idle")


def test_diagnostics_come_each_second_and_warn_of_strangers():
    transport, host = guarded(stream())
    heard = transport.listen("/diagnostics")
    transport.advance(3 * SECOND)
    assert len(heard) == 3
    assert host.statuses()[0].level == 0
    transport.publisher("/cmd_vel", peer("/rogue"))
    assert host.statuses()[0].level == 1
    transport.advance(SECOND)
    assert b"/rogue" in heard[-1]


def test_late_subscribers_get_the_latched_words_in_the_order_they_were_said():
    transport, _ = guarded_map(
        Flow(name="flow1", publisher="/a"), Flow(name="flow2", publisher="/b")
    )
    first = transport.publisher("/rtron/map/flow1", peer("/a", latching=True))
    second = transport.publisher("/rtron/map/flow2", peer("/b", latching=True))
    first(b"a1")
    second(b"b1")
    first(b"a2")
    assert transport.listen("/rtron/map/out") == [b"b1", b"a2"]


def test_an_old_velocity_is_not_told_to_a_late_subscriber():
    transport, _ = guarded(stream())
    transport.publisher(NAV, peer("/nav", latching=True))(b"fast")
    assert transport.listen(OUT) == []


def test_the_list_of_strangers_is_bounded():
    transport, host = guarded(stream())
    for number in range(1000):
        transport.publisher("/cmd_vel", peer(f"/{'x' * 1000}{number}"))
        transport.publisher("/cmd_vel", peer(f"/rogue_{number}"))
    assert len(host.streams[0].strangers) <= 32
    assert max(map(len, host.streams[0].strangers)) <= 128


def test_a_timer_that_is_always_due_does_not_hold_up_the_loop():
    loop = EventLoop()
    runs = []

    def again():
        runs.append(1)
        loop.call_at(0, again)

    again()
    for _ in range(20):
        loop.step(0.01)
    assert len(runs) == 21
    loop.close()
