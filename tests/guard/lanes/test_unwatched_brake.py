"""A robot without an audit is stopped after a while, and goes on when there is one again."""

from contextlib import closing

import pytest
from plans import grcn, plan_of
from streams import peer
from velocity_messages import speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.unwatched_brake import (
    LONGEST_UNWATCHED,
    SHORTEST_AUDIT,
    UnwatchedBrake,
)
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, build_streams

NAV, OUT = "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/out"


class Connection:
    is_connected = True


class World:
    """A guard whose time the test passes, second by second."""

    def __init__(self, loop):
        self.transport, self.connection, self.loop = MemoryTransport(), Connection(), loop
        loop.now = self.transport.now
        plan = plan_of(grcn("/cmd_vel", ["/nav"], ["/driver"]))
        self.host = Coordinator(self.transport, build_streams(plan))
        self.host.open()
        self.driver = self.transport.listen(OUT)
        self.nav = self.transport.publisher(NAV, peer("/nav"))
        UnwatchedBrake(self.connection, self.host, loop).open()

    def pass_seconds(self, number):
        for _ in range(number):
            self.transport.advance(SECOND)
            self.loop.step(0)

    @property
    def drives(self):
        self.nav(twist(0.5))
        return speeds(self.driver)[-1][0] == 0.5


@pytest.fixture
def world():
    with closing(EventLoop()) as loop:
        yield World(loop)


SECONDS = LONGEST_UNWATCHED // SECOND
BACK = SHORTEST_AUDIT // SECOND + 1


def test_a_robot_with_an_audit_drives_on(world):
    world.pass_seconds(10 * SECONDS)
    assert world.drives


def test_a_short_absence_stops_nobody(world):
    world.connection.is_connected = False
    world.pass_seconds(SECONDS)
    assert world.drives
    world.connection.is_connected = True
    world.pass_seconds(BACK)
    world.connection.is_connected = False
    world.pass_seconds(SECONDS)
    assert world.drives


def test_an_audit_that_ends_again_and_again_counts_as_none(world):
    for _ in range(SECONDS):
        for world.connection.is_connected in (True, False):
            world.pass_seconds(BACK - 2)
    assert not world.drives


def test_a_long_one_stops_the_robot_until_the_audit_is_back(world):
    assert world.drives
    world.connection.is_connected = False
    world.pass_seconds(SECONDS + 1)
    assert not world.drives
    world.pass_seconds(1)
    assert speeds(world.driver)[-1] == (0.0, 0.0)
    assert "nobody looks for intruders" in world.host.streams[0].brake_reason
    world.connection.is_connected = True
    world.pass_seconds(BACK)
    assert world.drives


def test_what_an_intruder_has_stopped_stays_stopped(world):
    world.host.streams[0].brake("the audit", "an intruder")
    world.connection.is_connected = False
    world.pass_seconds(SECONDS + 1)
    world.connection.is_connected = True
    world.pass_seconds(BACK)
    assert not world.drives
