"""What a client publishes before the guard hears it waits or is refused, and the client knows."""

import pytest

from rtron.bridge.common.guarded_output import HELD_FOR, GuardedOutput
from rtron.guard.transport.common.memory import MemoryTransport

GUARD = "/rtron/gr_base"
STRING, TWIST = "std_msgs/String", "geometry_msgs/Twist"


class Publishing:
    """A topic of a client, at a guard that is there or not."""

    def __init__(self, type=STRING, listeners=(GUARD,)):
        self.transport = MemoryTransport()
        self.transport.unreachable.add(GUARD)
        output = self.transport.advertise("/bridge/web", "/topic", type)
        self.sent, self.problems = self.transport.listen("/topic"), []
        self.output = GuardedOutput(
            self.transport, output, "/topic", type, listeners, self.problems.append
        )

    def come(self):
        self.transport.unreachable.clear()

    def go(self):
        self.transport.unreachable.add(GUARD)


REFUSAL = "/topic: the guard does not hear you yet, send it again"
DROPPED = "/topic: the guard has not come, what you sent is dropped"


def test_a_request_waits_for_the_guard_that_comes():
    web = Publishing()
    web.output.publish(b"acquire")
    web.come()
    web.transport.advance(HELD_FOR)
    assert (web.sent, web.problems) == ([b"acquire"], [])


def test_a_request_that_has_waited_in_vain_is_told_and_the_next_one_refused():
    web = Publishing()
    web.output.publish(b"acquire")
    web.output.publish(b"renew")
    web.transport.advance(HELD_FOR)
    assert web.problems == [DROPPED]
    web.output.publish(b"renew")
    assert web.problems == [DROPPED, REFUSAL]
    web.come()
    web.output.publish(b"acquire")
    assert web.sent == [b"acquire", b"renew", b"acquire"]
    assert len(web.problems) == 2


@pytest.mark.parametrize("type", [TWIST, "geometry_msgs/msg/Twist"])
def test_a_velocity_does_not_wait(type):
    web = Publishing(type)
    web.output.publish(b"fast")
    assert (web.sent, web.problems) == ([], [REFUSAL])
    web.come()
    web.output.publish(b"fast")
    web.transport.advance(HELD_FOR)
    assert (web.sent, web.problems) == ([b"fast"], [REFUSAL])


def test_what_a_guard_that_has_gone_would_not_hear_is_refused():
    web = Publishing()
    web.come()
    web.output.publish(b"acquire")
    web.go()
    web.output.publish(b"renew")
    assert (web.sent, web.problems) == ([b"acquire"], [REFUSAL])


def test_a_client_that_has_left_is_told_nothing():
    web = Publishing()
    web.output.publish(b"acquire")
    web.output.close()
    web.transport.advance(HELD_FOR)
    assert web.problems == []


def test_a_topic_that_is_not_the_guard_s_needs_none():
    web = Publishing(TWIST, listeners=())
    web.output.publish(b"any")
    assert (web.sent, web.problems) == ([b"any"], [])
