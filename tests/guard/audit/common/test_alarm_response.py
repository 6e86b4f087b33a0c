"""How long the audit's stop is told, and to whom: the guard as it is, on a clock of the test's."""

import struct

import pytest
from plans import grcn, plan_of

from bench.ros1.intruder import TWIST
from rtron.errors import WireError
from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.message_types import standard_info
from rtron.guard.intrusion_latch import intrusions_in
from rtron.guard.settings.intrusion_clearing import ClearCommands
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    SECOND,
    Alarm,
    AlarmKind,
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
MILLISECOND = SECOND // 1000
GOAL = "actionlib/TestActionGoal"


def twist(x):
    return struct.pack("<I6d", 48, x, 0, 0, 0, 0, 0)


def standard_peer(node, type):
    return Peer(node, standard_info(type, Encoding.ROS1))


REST = twist(0)


class BrakedStream:
    """A guard whose audit finds what the test says."""

    def __init__(self, plan=PLAN, on_foreign=OnForeign.STOP, handover=None):
        self.transport = MemoryTransport()
        self.host = Coordinator(self.transport, build_streams(plan), handover=handover)
        self.response = AlarmResponse(self.host, self.transport, on_foreign, dry_run=False)
        self.host.open()

    def find(self, alarm=GHOST, topic=TOPIC):
        self.response.raise_(alarm, self.transport.now(), topic)

    def lose(self, alarm=GHOST):
        self.response.settle(alarm)

    def clear(self, topic=TOPIC, reason="seen to"):
        request = {"clear": topic, "reason": reason}
        return ClearCommands(self.host).handle("ann", request).result(timeout=0)

    def intrude(self, lasts=LONG, topic=TOPIC):
        self.find(topic=topic)
        self.transport.advance(lasts)
        self.lose()
        if self.response.stops_streams:
            self.clear(topic)

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
    assert len(heard) == 1 + LONG // STOP.period


def test_one_of_two_alarms_that_is_settled_ends_nothing(braked):
    braked.find()
    braked.find(ROGUE)
    braked.lose()
    braked.advance()
    nav, heard = braked.nav(), braked.transport.listen(OUT)
    nav(twist(1.0))
    braked.advance()
    assert set(heard) == {REST}
    assert len(heard) == 1 + LONG // STOP.period


def test_who_comes_while_the_intruder_is_there_opens_nothing(braked):
    braked.find()
    nav, heard = braked.nav(), braked.come()
    nav(twist(1.0))
    braked.advance()
    assert set(heard) == {REST}
    assert len(heard) == 1 + LONG // STOP.period


def test_the_robot_stays_at_rest_when_the_intruder_is_gone_until_a_person_clears_it(braked):
    braked.find()
    braked.lose()
    nav, heard = braked.nav(), braked.transport.listen(OUT)
    nav(twist(1.0))
    braked.advance()
    assert set(heard) == {REST}
    (alarm,) = braked.host.alarms.active
    assert (alarm.kind, alarm.topic) == (AlarmKind.INTRUSION, TOPIC)
    assert braked.clear("") == {"cleared": [TOPIC]}
    assert braked.host.alarms.active == ()
    nav(twist(1.0))
    assert heard[-1] == twist(1.0)


def test_it_is_not_cleared_while_the_intruder_is_there(braked):
    braked.find()
    with pytest.raises(WireError, match="/cmd_vel stays stopped: a ghost"):
        braked.clear()
    assert braked.host.streams[0].brake_reason == "a ghost"


def test_it_is_not_cleared_while_the_audit_still_hears_the_intruder(braked):
    braked.find()
    braked.lose()
    braked.response.dismiss = lambda topic, _is_audible: f"{topic} may be driven"
    with pytest.raises(WireError, match="/cmd_vel may be driven"):
        braked.clear()


@pytest.mark.parametrize(
    ("request_", "why"),
    [
        ({"clear": TOPIC}, "a request has clear, reason"),
        ({"clear": TOPIC, "reason": " "}, "needs a reason"),
        ({"clear": TOPIC, "reason": "\u200b\u2060"}, "needs a reason"),
        ({"clear": TOPIC, "reason": "\u2800\u3164 \u115f"}, "needs a reason"),
        ({"clear": TOPIC, "reason": 1}, "a reason is a text"),
        ({"clear": "/other", "reason": "x"}, "no intruder has stopped '/other'"),
        ({"clear": ["/cmd_vel"], "reason": "x"}, "no intruder has stopped"),
    ],
)
def test_a_request_that_is_wrong_clears_nothing(braked, request_, why):
    braked.intrude(0)
    with pytest.raises(WireError, match=r"no intruder has stopped anything|needs|a re"):
        ClearCommands(braked.host).handle("ann", request_)
    braked.find()
    braked.lose()
    with pytest.raises(WireError, match=why):
        ClearCommands(braked.host).handle("ann", request_)
    assert braked.host.streams[0].brake_reason == "a ghost"


def test_who_cleared_it_and_why_is_logged_on_one_line_and_told(braked, caplog):
    told = []
    braked.host.intrusions.on_clear = lambda *facts: told.append(facts)
    braked.find()
    braked.lose()
    braked.clear(reason="a forgotten\nrostopic")
    assert told == [(TOPIC, "by ann: a forgotten rostopic")]
    assert "/cmd_vel: cleared by ann: a forgotten rostopic" in caplog.messages


def test_the_next_guard_goes_on_with_the_stop_before_it_opens():
    documents = []
    braked = BrakedStream(handover=HandoverState(write=documents.append))
    braked.find()
    braked.lose()
    following = BrakedStream(handover=HandoverState(documents[-1], documents.append))
    nav, heard = following.nav(), following.transport.listen(OUT)
    nav(twist(1.0))
    following.advance()
    assert set(heard) == {REST}
    assert set(intrusions_in(documents[-1])) == {TOPIC}
    following.clear()
    assert intrusions_in(documents[-1]) == {}
    nav(twist(1.0))
    assert heard[-1] == twist(1.0)


@pytest.mark.parametrize("document", [b"", b"{", b"[]", b'{"intrusions": 1}', b"[" * 100_000])
def test_a_document_that_is_none_has_no_intrusions(document):
    assert intrusions_in(document) == {}


def test_an_inherited_stop_of_a_topic_that_is_not_guarded_stops_nothing():
    handover = HandoverState(b'{"intrusions": {"/other": "a ghost", "/cmd_vel": 1}}')
    braked = BrakedStream(handover=handover)
    assert braked.host.alarms.active == ()


def test_a_mistaken_alarm_stops_nothing_any_more(braked):
    braked.find()
    braked.response.withdraw(GHOST)
    assert braked.host.alarms.active == ()
    nav, heard = braked.nav(), braked.transport.listen(OUT)
    nav(twist(1.0))
    assert heard[-1] == twist(1.0)


def test_a_mistaken_alarm_beside_a_true_one_releases_nothing(braked):
    braked.find(ROGUE)
    braked.find()
    braked.lose(ROGUE)
    braked.response.withdraw(GHOST)
    assert braked.host.streams[0].brake_reason == "a rogue"


def test_each_message_of_an_intruder_is_answered_at_once_with_the_stop(braked):
    braked.find()
    braked.advance(STOP.period // 2)
    heard = braked.transport.listen(OUT)
    assert heard == [REST]
    for _ in range(3):
        braked.response.answer(TOPIC, twist(0.5))
        braked.advance(2 * MILLISECOND)
    assert heard == [REST] * 4


def test_answers_are_bounded_and_the_last_message_is_answered_all_the_same(braked):
    braked.find()
    braked.advance(STOP.period // 2)
    heard = braked.transport.listen(OUT)
    for _ in range(100):
        braked.response.answer(TOPIC, twist(0.5))
    assert heard == [REST] * 2
    braked.advance(MILLISECOND)
    assert heard == [REST] * 3
    braked.advance(5 * MILLISECOND)
    assert heard == [REST] * 3


def test_a_message_that_moves_nothing_needs_no_answer(braked):
    braked.find()
    braked.advance(STOP.period // 2)
    heard = braked.transport.listen(OUT)
    braked.response.answer(TOPIC, REST)
    braked.advance(5 * MILLISECOND)
    assert heard == [REST]


@pytest.mark.parametrize("message", [b"", twist(float("nan")), bytes(3)])
def test_what_cannot_be_read_is_answered(braked, message):
    braked.find()
    braked.advance(STOP.period // 2)
    heard = braked.transport.listen(OUT)
    braked.response.answer(TOPIC, message)
    assert heard == [REST] * 2


def test_nobody_is_answered_when_nothing_is_stopped(braked):
    heard = braked.transport.listen(OUT)
    braked.response.answer(TOPIC, twist(0.5))
    braked.advance()
    assert heard == []


def test_an_answer_goes_on_with_the_ramp(braked):
    braked.nav()(twist(1.0))
    heard = braked.transport.listen(OUT)
    braked.find()
    braked.advance(STOP.period // 2)
    braked.response.answer(TOPIC, twist(0.5))
    first, answer = (struct.unpack_from("<d", each, 4)[0] for each in heard[-2:])
    assert 0 < answer <= first < 1


def test_what_may_pass_does_so_at_once_and_ends_the_stop(braked):
    nav = braked.nav()
    braked.intrude()
    heard = braked.transport.listen(OUT)
    nav(twist(1.0))
    assert heard == [REST, twist(1.0)]
    braked.advance(SECOND // 4)
    assert heard == [REST, twist(1.0)]


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


class LateAudit:
    """Answers when the test says; an intruder was heard `silent_for` (ns) ago."""

    def __init__(self, braked):
        self.silent_for, self.asked = LONG, []
        braked.response.query_audit = lambda topic, is_audible, answer: self.asked.append(answer)
        braked.response.listener = self

    def silence(self, _topic):
        return self.silent_for

    def update(self):
        """Do nothing when another stream is stopped."""


@pytest.fixture
def late(braked):
    """Return the audit of a stream that an intruder has stopped, who is gone."""
    braked.find()
    braked.lose()
    return LateAudit(braked)


def ask_to_clear(braked, by="ann"):
    return ClearCommands(braked.host).handle(by, {"clear": TOPIC, "reason": "seen to"})


def test_an_intruder_that_speaks_while_the_audit_is_asked_is_not_cleared(braked, late):
    asked = ask_to_clear(braked)
    late.silent_for = MILLISECOND
    late.asked[0]("")
    with pytest.raises(WireError, match="has spoken within the last second"):
        asked.result(timeout=0)
    assert braked.response.stopped_streams == {TOPIC}


def test_of_two_people_who_clear_at_once_one_is_told_that_the_other_has(braked, late):
    cleared = []
    braked.host.intrusions.on_clear = lambda topic, by: cleared.append(by)
    first, second = ask_to_clear(braked), ask_to_clear(braked, "ben")
    for answer in late.asked:
        answer("")
    assert first.result(timeout=0) == {"cleared": [TOPIC]}
    with pytest.raises(WireError, match="somebody else has just cleared it"):
        second.result(timeout=0)
    assert cleared == ["by ann: seen to"]


def test_one_that_was_taken_for_gone_and_speaks_stops_the_stream_without_the_audit(braked, late):
    ask_to_clear(braked)
    late.asked[0]("")
    assert not braked.response.stopped_streams
    returned = []
    braked.response.on_return = returned.append
    braked.response.note_return(TOPIC, b"gid")
    assert (braked.response.stopped_streams, returned) == ({TOPIC}, [b"gid"])
    asked = ask_to_clear(braked)
    late.asked[1]("")
    assert asked.result(timeout=0) == {"cleared": [TOPIC]}
