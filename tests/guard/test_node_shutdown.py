"""Calls to shut one of the guard's nodes down, with a supervisor and without."""

import pytest
from streams import peer, stage, stream
from velocity_messages import speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.node_shutdown import ShutdownRefusal, ShutdownSequence
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import GUARD_NODE, SECOND, StopProfile

OUT, NAV = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1"
NODE = "/rtron/grcn_cmd_vel"
STOP = StopProfile(decel=10.0, angular_decel=10.0, period=SECOND // 50, repeat=SECOND // 10)


class RemovalTransport(MemoryTransport):
    """Records each node that leaves the graph, with what the driver had received by then."""

    def __init__(self, loop):
        super().__init__()
        self.now, self.call_at = loop.now, loop.call_at
        self.removed = []

    def remove_node(self, name):
        self.removed.append((name, speeds(self.driver)))


class UnsupervisedGuard:
    """A guard without a supervisor, and a robot that moves."""

    def __init__(self):
        self.loop = EventLoop()
        self.transport = RemovalTransport(self.loop)
        self.coordinator = Coordinator(self.transport, [stream(stage(), stop=STOP)])
        self.coordinator.open()
        self.transport.driver = self.transport.listen(OUT)
        self.shutdown = ShutdownSequence(self.coordinator, self.transport, self.loop)

    def move(self):
        self.transport.publisher(NAV, peer("/nav"))(twist(1.0))

    def run(self):
        while not self.transport.removed:
            self.loop.step(0.01)


@pytest.fixture
def guard():
    guard = UnsupervisedGuard()
    yield guard
    guard.loop.close()


@pytest.mark.parametrize("node", [NODE, GUARD_NODE])
def test_a_node_leaves_once_the_robot_was_stopped(guard, node):
    guard.move()
    guard.shutdown.handle(node, "a test")
    guard.shutdown.handle(node, "a test")
    assert guard.transport.removed == []
    guard.run()
    ((node_left, received),) = guard.transport.removed
    assert node_left == node
    assert received[0] == (1.0, 0.0)
    assert 0 < received[1][0] < 1
    assert received[-1] == (0.0, 0.0)


def test_a_node_that_moves_nothing_leaves_at_once(guard):
    guard.shutdown.handle(NODE, "a test")
    assert guard.transport.removed == [(NODE, [])]


def test_the_guard_ends_with_its_own_node(guard):
    guard.loop.post(lambda: guard.shutdown.handle(GUARD_NODE, "a test"))
    guard.loop.run()
    assert guard.transport.removed[0][0] == GUARD_NODE


def test_a_refusal_is_logged_once_a_second_and_cut_short(guard, caplog):
    refusal = ShutdownRefusal(guard.loop)
    for _ in range(100):
        refusal.handle(NODE, "one\nline " + "x" * 10_000)
    (record,) = caplog.records
    text = record.getMessage()
    assert text.startswith(f"{NODE} is not shut down, end rtron guard itself: one\\n")
    assert len(text) < 300
