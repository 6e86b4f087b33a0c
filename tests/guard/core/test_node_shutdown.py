"""Calls to shut one of the guard's nodes down, with a supervisor and without."""

import pytest
from streams import peer, stage, stream
from velocity_messages import speeds, twist

from rtron.guard.core.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.node_shutdown import ShutdownRefusal, ShutdownSequence
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import GUARD_NODE, SECOND, StopProfile

OUT, NAV = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1"
NODE = "/rtron/grcn_cmd_vel"
STOP = StopProfile(decel=10.0, angular_decel=10.0, period=SECOND // 50, repeat=SECOND // 10)


class Told(MemoryTransport):
    """Keeps which nodes left the graph, and how much the driver had been told by then."""

    def __init__(self, loop):
        super().__init__()
        self.now, self.call_at = loop.now, loop.call_at
        self.left = []

    def remove(self, node):
        self.left.append((node, speeds(self.driver)))


class Guarded:
    """A guard without a supervisor, and a robot that moves."""

    def __init__(self):
        self.loop = EventLoop()
        self.transport = Told(self.loop)
        self.host = Coordinator(self.transport, [stream(stage(), stop=STOP)])
        self.host.open()
        self.transport.driver = self.transport.listen(OUT)
        self.obeying = ShutdownSequence(self.host, self.transport, self.loop)

    def move(self):
        self.transport.publisher(NAV, peer("/nav"))(twist(1.0))

    def run(self):
        while not self.transport.left:
            self.loop.step(0.01)


@pytest.fixture
def guarded():
    made = Guarded()
    yield made
    made.loop.close()


@pytest.mark.parametrize("node", [NODE, GUARD_NODE])
def test_a_node_leaves_when_the_robot_was_told_to_rest(guarded, node):
    guarded.move()
    guarded.obeying.handle(node, "a test")
    guarded.obeying.handle(node, "a test")
    assert guarded.transport.left == []
    guarded.run()
    ((left, told),) = guarded.transport.left
    assert left == node
    assert told[0] == (1.0, 0.0)
    assert 0 < told[1][0] < 1
    assert told[-1] == (0.0, 0.0)


def test_a_node_that_moves_nothing_leaves_at_once(guarded):
    guarded.obeying.handle(NODE, "a test")
    assert guarded.transport.left == [(NODE, [])]


def test_the_guard_ends_with_its_own_node(guarded):
    guarded.loop.post(lambda: guarded.obeying.handle(GUARD_NODE, "a test"))
    guarded.loop.run()
    assert guarded.transport.left[0][0] == GUARD_NODE


def test_a_refusal_is_told_once_a_second_and_in_few_words(guarded, caplog):
    refusing = ShutdownRefusal(guarded.loop)
    for _ in range(100):
        refusing.handle(NODE, "one\nline " + "x" * 10_000)
    (record,) = caplog.records
    told = record.getMessage()
    assert told.startswith(f"{NODE} is not shut down, end rtron guard itself: one\\n")
    assert len(told) < 300
