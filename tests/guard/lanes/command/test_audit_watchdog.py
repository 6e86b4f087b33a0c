"""A stream after which the audit has not looked for too long is stopped until it looks again."""

from contextlib import closing

import pytest
from plans import grcn, plan_of
from streams import peer
from velocity_messages import speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.lanes.command.audit_watchdog import AuditWatchdog
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, AlarmKind, Audit, OnForeign, Supervision, build_streams

NAV, OUT = "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/out"
SECONDS = 7
HANGS = {"/cmd_vel": "/driver cannot be audited: no answer within 1 s"}


class Connection:
    """The bulk process, whose rounds the test tells."""

    def __init__(self):
        self.loss_listeners = []

    def on(self, audit_round):
        self.tell = audit_round

    def lose(self):
        for listener in self.loss_listeners:
            listener()


class World:
    """A guard whose time the test passes, second by second."""

    def __init__(self, loop, on_foreign=OnForeign.STOP, left=b"", now=0):
        self.transport, self.bulk, self.loop = MemoryTransport(), Connection(), loop
        self.transport.advance(now)
        loop.now = self.transport.now
        self.left = left
        nodes = grcn("/cmd_vel", ["/nav"], ["/driver"]), grcn("/arm", ["/mover"], ["/servo"])
        supervision = Supervision(audit_within=SECONDS * SECOND)
        plan = plan_of(*nodes, audit=Audit(on_foreign=on_foreign), supervision=supervision)
        self.host = Coordinator(self.transport, build_streams(plan))
        self.host.open()
        self.driver = self.transport.listen(OUT)
        self.nav = self.transport.publisher(NAV, peer("/nav"))
        handover = HandoverState(left, self._keep)
        AuditWatchdog(self.bulk, self.host, loop, plan, handover).open()

    def _keep(self, document):
        self.left = document

    def successor(self):
        """Return the guard that takes this one's place a second after it has ended."""
        return World(self.loop, left=self.left, now=self.transport.now() + SECOND)

    def pass_seconds(self, number, message=None):
        for _ in range(number):
            self.transport.advance(SECOND)
            if message is not None:
                self.bulk.tell(message)
            self.loop.step(0)

    @property
    def drives(self):
        self.nav(twist(0.5))
        return speeds(self.driver)[-1][0] == 0.5

    @property
    def alarms(self):
        return {each.topic: each.reason for each in self.host.alarms.active}


@pytest.fixture
def loop():
    with closing(EventLoop()) as loop:
        yield loop


@pytest.fixture
def world(loop):
    return World(loop)


ALL_SEEN = {}


def test_a_robot_with_an_audit_drives_on(world):
    world.pass_seconds(10 * SECONDS, ALL_SEEN)
    assert world.drives
    assert world.alarms == {}


def test_a_short_absence_stops_nobody(world):
    for _ in range(3):
        world.pass_seconds(SECONDS)
        assert world.drives
        world.bulk.tell(ALL_SEEN)


@pytest.mark.parametrize("message", [None, HANGS])
def test_an_audit_that_tells_no_round_counts_as_none(world, message):
    """It hangs, or it begins and ends again and again, or nobody answers it."""
    assert world.drives
    world.pass_seconds(SECONDS, message)
    assert world.drives
    world.pass_seconds(1, message)
    assert not world.drives
    world.pass_seconds(1)
    assert speeds(world.driver)[-1] == (0.0, 0.0)
    gap = HANGS["/cmd_vel"] if message else "the audit does not answer"
    reason = f"nobody has looked for intruders for 7 s: {gap}"
    assert world.host.streams[0].brake_reason == reason
    assert world.alarms["/cmd_vel"] == f"/cmd_vel: {reason}"
    assert {each.kind for each in world.host.alarms.active} == {AlarmKind.UNREACHABLE}


def test_the_stream_goes_on_as_soon_as_somebody_looks(world):
    world.pass_seconds(SECONDS + 1)
    assert not world.drives
    world.pass_seconds(1, ALL_SEEN)
    assert world.drives
    assert world.alarms == {}


def test_only_the_stream_that_nobody_looks_after_is_stopped(world):
    world.pass_seconds(2 * SECONDS, {"/arm": "/servo cannot be audited"})
    assert world.drives
    assert list(world.alarms) == ["/arm"]


def test_the_reason_of_an_audit_that_is_gone_is_that_it_does_not_answer(world):
    world.pass_seconds(2, HANGS)
    world.bulk.lose()
    world.pass_seconds(SECONDS)
    assert "the audit does not answer" in world.alarms["/cmd_vel"]


def test_what_an_intruder_has_stopped_stays_stopped(world):
    world.host.streams[0].brake("the audit", "an intruder")
    world.pass_seconds(SECONDS + 1)
    world.pass_seconds(1, ALL_SEEN)
    assert not world.drives


def test_where_intruders_stop_nothing_there_is_an_alarm_only(loop):
    world = World(loop, OnForeign.ALARM)
    world.pass_seconds(SECONDS + 1)
    assert world.drives
    assert set(world.alarms) == {"/cmd_vel", "/arm"}
    world.pass_seconds(1, ALL_SEEN)
    assert world.alarms == {}


def test_the_stop_outlives_the_guard(world):
    world.pass_seconds(SECONDS + 1)
    successor = world.successor()
    assert not successor.drives
    assert set(successor.alarms) == {"/cmd_vel", "/arm"}
    successor.pass_seconds(2, HANGS)
    assert not successor.drives
    assert list(successor.alarms) == ["/cmd_vel"]
    successor.pass_seconds(1, ALL_SEEN)
    assert successor.drives
    assert successor.alarms == {}


def test_guards_that_end_one_after_the_other_are_late_together(world):
    world.pass_seconds(SECONDS // 2)
    second = world.successor()
    assert second.drives
    second.pass_seconds(SECONDS // 2)
    assert second.drives
    third = second.successor()
    assert not third.drives


def test_a_guard_after_one_that_was_audited_drives(world):
    world.pass_seconds(2 * SECONDS, ALL_SEEN)
    successor = world.successor()
    assert successor.drives
    successor.pass_seconds(SECONDS - 2)
    assert successor.drives


@pytest.mark.parametrize("left", ["[]", '{"/cmd_vel": "x"}', f'{{"/cmd_vel": {10**30}}}'])
def test_times_that_nobody_can_have_left_count_as_none(loop, left):
    world = World(loop, left=f'{{"audited": {left}}}'.encode())
    world.pass_seconds(SECONDS)
    assert world.drives
    world.pass_seconds(1)
    assert not world.drives
