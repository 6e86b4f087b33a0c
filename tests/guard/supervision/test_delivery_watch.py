"""The supervisor's pings through the guard: what comes back, what does not, and what is forged."""

import pytest

from rtron.guard.core.report_messages import STRING, UINT64
from rtron.guard.supervision.delivery_watch import (
    ECHO_TOPIC,
    PING_PERIOD,
    PING_TOPIC,
    DeliveryEcho,
    DeliveryWatch,
)
from rtron.guard.supervision.watchdog import BEAT_PERIOD
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import GUARD_NODE, SECOND, SUPERVISOR_NODE

GUARD, SUPERVISOR = Peer(GUARD_NODE, UINT64), Peer(SUPERVISOR_NODE, UINT64)


class Watched:
    """A supervisor and a guard, each with a middleware of its own, between which a test carries."""

    def __init__(self, encoding=Encoding.ROS1):
        self.near, self.far = MemoryTransport(encoding), MemoryTransport(encoding)
        self.watch = DeliveryWatch(self.near, 0)
        DeliveryEcho(self.far).open()
        self.pings = self.near.listen(PING_TOPIC)
        self.echoes = self.far.listen(ECHO_TOPIC)
        self.into_guard = self.far.publisher(PING_TOPIC, SUPERVISOR)
        self.out_of_guard = self.near.publisher(ECHO_TOPIC, GUARD)
        self.now = 0

    def run(self, duration, *, delivers=True):
        """Let time pass; return what was told at last."""
        for _ in range(duration // BEAT_PERIOD):
            self.now += BEAT_PERIOD
            silence = self.watch.tick(self.now)
            if delivers:
                self.deliver()
        return silence

    def deliver(self):
        while self.pings:
            self.into_guard(self.pings.pop(0))
        while self.echoes:
            self.out_of_guard(self.echoes.pop(0))


@pytest.mark.parametrize("encoding", Encoding)
def test_pings_that_come_back_leave_no_more_silence_than_their_period(encoding):
    watched = Watched(encoding)
    worst = max(watched.run(BEAT_PERIOD) for _ in range(100))
    assert watched.watch.is_known
    assert 0 < worst <= PING_PERIOD


def test_silence_grows_while_nothing_comes_back_and_ends_with_the_first_that_does():
    watched = Watched()
    watched.run(SECOND)
    silence = watched.run(SECOND, delivers=False)
    assert SECOND <= silence <= SECOND + PING_PERIOD
    watched.deliver()
    assert watched.run(BEAT_PERIOD) == 0


def test_before_the_first_ping_has_come_back_nothing_is_known():
    watched = Watched()
    assert watched.run(10 * SECOND, delivers=False) == 0
    assert not watched.watch.is_known


def test_a_guard_that_has_sent_nothing_back_for_30_s_is_unwatched_until_it_does(caplog):
    watched = Watched()
    watched.run(29 * SECOND, delivers=False)
    assert not watched.watch.is_unwatched
    watched.run(2 * SECOND, delivers=False)
    assert watched.watch.is_unwatched
    assert caplog.text.count("its delivery is not watched") == 1
    watched.run(SECOND)
    assert not watched.watch.is_unwatched


def test_a_guard_that_was_watched_once_is_never_unwatched():
    watched = Watched()
    watched.run(SECOND)
    watched.run(40 * SECOND, delivers=False)
    assert not watched.watch.is_unwatched


def test_the_next_guard_is_not_unwatched_yet():
    watched = Watched()
    watched.run(31 * SECOND, delivers=False)
    watched.watch.reset(watched.now)
    watched.run(SECOND, delivers=False)
    assert not watched.watch.is_unwatched


def test_another_guard_is_not_known_yet():
    watched = Watched()
    watched.run(SECOND)
    watched.watch.reset(watched.now)
    assert not watched.watch.is_known
    assert watched.run(SECOND, delivers=False) == 0


def test_late_pings_of_the_guard_before_say_nothing_about_the_next_one():
    watched = Watched()
    watched.run(SECOND)
    watched.run(PING_PERIOD, delivers=False)
    watched.watch.reset(watched.now)
    watched.deliver()
    assert not watched.watch.is_known


@pytest.mark.parametrize(
    "peer",
    [Peer("/rogue", UINT64), Peer(GUARD_NODE, UINT64, verified=False), Peer(GUARD_NODE, STRING)],
)
def test_nobody_else_answers_for_the_guard(peer):
    watched = Watched()
    watched.run(SECOND)
    forge = watched.near.publisher(ECHO_TOPIC, peer)
    for _ in range(50):
        silence = watched.run(BEAT_PERIOD, delivers=False)
        forge(watched.pings[-1])
    assert silence >= SECOND // 2


@pytest.mark.parametrize("peer", [Peer("/rogue", UINT64), Peer(GUARD_NODE, UINT64)])
def test_the_guard_answers_nobody_but_the_supervisor(peer):
    watched = Watched()
    watched.far.publisher(PING_TOPIC, peer)(b"\x08\0\0\0" + bytes(8))
    assert watched.echoes == []


@pytest.mark.parametrize(
    "message",
    [b"", b"\x08\0\0\0", b"\x08\0\0\0" + b"\xff" * 8, b"\x08\0\0\0" + bytes(8), bytes(99)],
)
def test_an_answer_to_no_ping_is_none(message):
    watched = Watched()
    watched.run(SECOND)
    watched.run(SECOND, delivers=False)
    watched.out_of_guard(message)
    assert watched.run(BEAT_PERIOD, delivers=False) >= SECOND
