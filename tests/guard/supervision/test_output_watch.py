"""The watch over what successors take: what is stuck, slow or idle, and who is watched."""

import pytest
from streams import FLOWS, stream

from rtron.guard.core.alarms import Alarms
from rtron.guard.supervision.output_watch import OutputWatch
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import SubscriberProgress
from rtron.vocabulary import SECOND, AlarmKind, Mode, flow_topic, output_topic

BOUND = SECOND // 2
OUT = output_topic("/cmd_vel")


class Watched(MemoryTransport):
    """A transport whose subscribers are as far as a test says."""

    def __init__(self, **spec):
        super().__init__()
        self.subscribers = {}
        self.alarms = Alarms()
        OutputWatch([stream(**spec)], self.alarms, self, BOUND).open()

    def subscriber_progress(self, topic):
        return self.subscribers.get(topic, [])

    def show(self, taken, *, is_awaited=True, node="/driver", topic=OUT):
        self.subscribers[topic] = [SubscriberProgress(node, "here:1", taken, is_awaited)]

    @property
    def stuck(self):
        return [(alarm.kind, alarm.topic, alarm.node) for alarm in self.alarms.active]


STUCK = [(AlarmKind.UNDELIVERED, "/cmd_vel", "/driver")]


def test_who_takes_nothing_is_told_after_the_bound_and_no_more_when_it_takes_something():
    watched = Watched()
    watched.show(100)
    watched.advance(BOUND)
    assert watched.stuck == []
    watched.advance(BOUND)
    assert watched.stuck == STUCK
    watched.show(152)
    watched.advance(BOUND // 4)
    assert watched.stuck == []


def test_who_takes_all_in_the_end_is_told_no_more():
    watched = Watched()
    watched.show(100)
    watched.advance(2 * BOUND)
    watched.show(100, is_awaited=False)
    watched.advance(BOUND // 4)
    assert watched.stuck == []


def test_who_is_slow_is_not_stuck():
    watched = Watched()
    for taken in range(20):
        watched.show(taken)
        watched.advance(BOUND * 3 // 4)
    assert watched.alarms.raised == 0


def test_bytes_that_seem_to_come_back_are_no_progress():
    """An acknowledgement is late: bytes count as waiting on both sides for a moment."""
    watched = Watched()
    for look in range(16):
        watched.show(100 - 52 * (look % 2))
        watched.advance(BOUND // 4)
    assert watched.stuck == STUCK


def test_what_is_not_known_for_a_moment_is_no_progress():
    watched = Watched()
    watched.show(100)
    watched.advance(2 * BOUND)
    watched.show(None)
    watched.advance(BOUND)
    assert watched.stuck == STUCK
    watched.show(152)
    watched.advance(BOUND // 4)
    assert watched.stuck == []


def test_a_look_that_fails_is_not_the_last(monkeypatch):
    watched = Watched()
    watched.show(100)
    with monkeypatch.context() as patch:
        patch.setattr(watched, "subscriber_progress", broken)
        with pytest.raises(OSError, match="broken"):
            watched.advance(BOUND // 4)
    watched.advance(3 * BOUND)
    assert watched.stuck == STUCK


def broken(_topic):
    raise OSError("broken")


def test_nobody_waits_for_who_gets_nothing():
    watched = Watched()
    watched.show(100, is_awaited=False)
    watched.advance(10 * BOUND)
    assert watched.alarms.raised == 0


def test_a_connection_that_ends_is_stuck_no_more():
    watched = Watched()
    watched.show(100)
    watched.advance(2 * BOUND)
    watched.subscribers.clear()
    watched.advance(BOUND // 4)
    assert watched.stuck == []


@pytest.mark.parametrize(
    ("spec", "shown"),
    [({}, {"node": "/rviz"}), ({}, {"topic": "/cmd_vel"}), ({"mode": Mode.OBSERVE}, {})],
)
def test_tools_and_what_is_only_observed_are_not_watched(spec, shown):
    watched = Watched(**spec)
    watched.show(100, **shown)
    watched.advance(4 * BOUND)
    assert watched.alarms.raised == 0


def test_a_successor_that_is_also_a_publisher_is_watched_on_its_own_topic():
    watched = Watched(successors=(FLOWS[0].publisher,))
    watched.show(1, node=FLOWS[0].publisher, topic=flow_topic("/cmd_vel", FLOWS[0].name))
    watched.advance(2 * BOUND)
    assert [node for _, _, node in watched.stuck] == [FLOWS[0].publisher]


def test_where_the_looks_are_late_a_successor_has_more_time():
    watched = Watched()
    watched.show(1)
    watched.advance(BOUND // 2)
    watched.jump(10 * BOUND)
    watched.advance(BOUND)
    assert watched.alarms.raised == 0
    watched.advance(2 * BOUND)
    assert watched.stuck == STUCK
