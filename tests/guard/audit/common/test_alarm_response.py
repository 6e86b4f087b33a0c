"""How long the audit's stop is told, and to whom: the guard as it is, on a clock of the test's."""

import struct
from dataclasses import replace

import pytest
from plans import grcn, plan_of

from bench.ros1.intruder import TWIST
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.runner import audit_response
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    SECOND,
    Alarm,
    AlarmKind,
    Audit,
    OnForeign,
    StopProfile,
    StreamKind,
    build_streams,
)

TOPIC, OUT, NAV = "/cmd_vel", "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1"
STOP = StopProfile(period=SECOND // 20, repeat=SECOND)
PLAN = plan_of(grcn(TOPIC, ["/nav"], ["/driver"]), stop=STOP)
TOLD = STOP.repeat // STOP.period
GHOST = Alarm(kind=AlarmKind.UNREGISTERED_PUBLISHER, reason="a ghost", node="/driver")
ROGUE = Alarm(kind=AlarmKind.FOREIGN_PUBLISHER, reason="a rogue", node="/driver")
LONG = 10 * SECOND
GOAL = "actionlib/TestActionGoal"


def twist(x):
    return struct.pack("<I6d", 48, x, 0, 0, 0, 0, 0)


def standard_peer(node, type):
    return Peer(node, standard_info(type, Encoding.ROS1))


REST = twist(0)


class BrakedStream:
    """A guard whose audit finds what the test says."""

    def __init__(self, plan=PLAN, on_foreign=OnForeign.STOP):
        self.transport = MemoryTransport()
        self.host = Coordinator(self.transport, build_streams(plan))
        self.host.open()
        self.response = audit_response(
            replace(plan, audit=Audit(on_foreign=on_foreign)),
            self.host,
            self.transport,
            dry_run=False,
        )

    def find(self, alarm=GHOST, topic=TOPIC):
        self.response.raise_(alarm, self.transport.now(), topic)

    def lose(self, alarm=GHOST):
        self.response.settle(alarm)

    def intrude(self, lasts=LONG, topic=TOPIC):
        self.find(topic=topic)
        self.transport.advance(lasts)
        self.lose()

    def come(self, topic=TOPIC):
        """Let a node come that listens from now on; return what it hears."""
        heard = self.transport.listen(OUT)
        self.response.on_new_listener(topic)
        return heard

    def nav(self):
        return self.transport.publisher(NAV, standard_peer("/nav", TWIST))

    def advance(self, duration=LONG):
        self.transport.advance(duration)


@pytest.fixture
def braked():
    return BrakedStream()


@pytest.mark.parametrize("lasts", [0, 1, STOP.repeat, LONG])
def test_the_stop_is_told_on_when_the_intruder_is_gone(braked, lasts):
    braked.intrude(lasts)
    heard = braked.transport.listen(OUT)
    braked.advance()
    assert set(heard) == {REST}
    assert abs(len(heard) - TOLD) <= 1


@pytest.mark.parametrize("since", [0, SECOND // 2, STOP.repeat - 1, STOP.repeat, LONG])
def test_who_comes_back_later_is_told_as_long(braked, since):
    braked.intrude()
    braked.advance(since)
    heard = braked.come()
    braked.advance()
    assert set(heard) == {REST}
    assert abs(len(heard) - TOLD) <= 1


def test_who_comes_back_is_told_at_once_when_all_was_said(braked):
    braked.intrude()
    braked.advance()
    heard = braked.come()
    braked.advance(0)
    assert heard == [REST]


def test_two_who_come_one_after_the_other_are_both_told_to_the_end(braked):
    braked.intrude()
    braked.advance()
    braked.come()
    braked.advance(STOP.repeat * 3 // 4)
    heard = braked.come()
    braked.advance()
    assert abs(len(heard) - TOLD) <= 1


def test_what_is_found_anew_is_stopped_for_as_long_as_it_stays(braked):
    braked.intrude()
    braked.advance(STOP.repeat // 2)
    braked.find(ROGUE)
    braked.advance()
    heard = braked.transport.listen(OUT)
    braked.advance()
    assert len(heard) == LONG // STOP.period


def test_one_of_two_alarms_that_is_settled_ends_nothing(braked):
    braked.find()
    braked.find(ROGUE)
    braked.lose()
    braked.advance()
    nav, heard = braked.nav(), braked.transport.listen(OUT)
    nav(twist(1.0))
    braked.advance()
    assert set(heard) == {REST}
    assert len(heard) == LONG // STOP.period


def test_who_comes_while_the_intruder_is_there_opens_nothing(braked):
    braked.find()
    nav, heard = braked.nav(), braked.come()
    nav(twist(1.0))
    braked.advance()
    assert set(heard) == {REST}
    assert len(heard) == LONG // STOP.period


def test_what_may_pass_does_so_at_once_and_ends_the_stop(braked):
    nav = braked.nav()
    braked.intrude()
    heard = braked.transport.listen(OUT)
    nav(twist(1.0))
    assert heard == [twist(1.0)]
    braked.advance(SECOND // 4)
    assert heard == [twist(1.0)]


def test_it_passes_also_while_somebody_who_came_back_is_told(braked):
    nav = braked.nav()
    braked.intrude()
    braked.advance()
    heard = braked.come()
    nav(twist(1.0))
    assert heard[-1] == twist(1.0)


def test_who_comes_while_the_robot_moves_is_told_nothing(braked):
    nav = braked.nav()
    braked.intrude()
    nav(twist(1.0))
    heard = braked.come()
    braked.advance(SECOND // 4)
    assert heard == []


def test_who_comes_after_another_stop_is_told_nothing(braked):
    nav = braked.nav()
    braked.intrude()
    nav(twist(1.0))
    braked.advance()
    heard = braked.come()
    braked.advance()
    assert heard == []


@pytest.mark.parametrize("on_foreign", OnForeign)
def test_who_comes_when_nothing_was_stopped_is_told_nothing(on_foreign):
    braked = BrakedStream(on_foreign=on_foreign)
    if on_foreign is OnForeign.ALARM:
        braked.intrude()
    heard = braked.come()
    braked.advance()
    assert heard == []


def test_a_stop_of_another_stream_is_not_told_here():
    braked = BrakedStream(
        plan_of(*PLAN.grcn, grcn("/arm", ["/planner"], ["/arm_driver"]), stop=STOP)
    )
    braked.intrude(topic="/arm")
    braked.advance()
    heard = braked.come()
    braked.advance()
    assert heard == []


def say(braked, topic, node, type, body):
    message = struct.pack("<I", len(body)) + body
    braked.transport.publisher(topic, standard_peer(node, type))(message)


def test_who_comes_to_an_action_ends_no_goal():
    act = grcn("/act/goal", ["/client"], ["/server"], type=GOAL, kind=StreamKind.ACTION)
    braked = BrakedStream(plan_of(act))
    goals = braked.transport.listen("/rtron/act/goal/out")
    cancels = braked.transport.listen("/rtron/act/cancel/out")
    braked.intrude(topic="/act/goal")
    assert braked.host.streams[0].brake_reason == ""
    say(braked, "/rtron/act/result/server", "/server", "actionlib/TestActionResult", b"")
    status = "actionlib_msgs/GoalStatusArray"
    say(braked, "/rtron/act/status/server", "/server", status, bytes(20))
    goal = bytes(24) + struct.pack("<I1si", 1, b"1", 0)
    say(braked, "/rtron/act/goal/flow1", "/client", GOAL, goal)
    assert len(goals) == 1
    braked.response.on_new_listener("/act/goal")
    braked.advance(0)
    assert cancels == []
