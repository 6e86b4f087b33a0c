"""A burst passes the guard whole on ROS 1; what a slow subscriber does not take is counted."""

import re
import signal

import pytest
from driven_base import start_guard
from harness import wait_for
from plans import grcn, plan_of

from rtron.vocabulary import PolicyName, StreamKind, flow_topic, output_topic

pytestmark = [
    pytest.mark.ros1,
    pytest.mark.parametrize("kind", [StreamKind.STATE, StreamKind.COMMAND]),
]
TOPIC, NODE = "/burst", "/rtron/grcn_burst"
FLOW, OUT = flow_topic(TOPIC, "flow1"), output_topic(TOPIC)
COUNT, LARGE = 500, 1 << 16
"""So many large messages have no room in the sockets of a subscriber that reads nothing."""
LOST = re.compile(rf"lost behind the guard, {OUT}\"\s+value: \"(\d+)\"")


class Burst:
    """A mapper before the guard and a reader behind it."""

    def __init__(self, ros1, kind):
        state = grcn(
            TOPIC,
            ["/mapper"],
            ["/reader"],
            type="std_msgs/String",
            kind=kind,
            policy=PolicyName.BLOCK,
        )
        self._ros1 = ros1
        self.guard = start_guard(ros1, plan_of(state), NODE)
        self.reader = ros1.node("numbered_texts.py", "/reader", f"{TOPIC}:={OUT}")
        wait_for(lambda: ros1.connected(NODE, "/reader", OUT), what="the reader's connection")

    def say(self, size):
        arguments = (str(COUNT), str(size), f"{TOPIC}:={FLOW}")
        self._ros1.node("numbered_texts.py", "/mapper", *arguments)

    def parts(self):
        """Return the numbers that the reader has heard."""
        return [int(number) for number in re.findall(r"part (\d+)\n", self.reader.log)]

    def wait_for_the_last(self):
        wait_for(lambda: self.parts()[-1:] == [COUNT - 1], what="the last part")

    def diagnostics(self):
        return self._ros1.run("rostopic", "echo", "-n", "1", "/diagnostics")

    def lost(self):
        """Return how many messages the diagnostics count as lost behind the guard."""
        return int((LOST.findall(self.diagnostics()) or [0])[-1])


def test_a_burst_arrives_whole(ros1, kind):
    burst = Burst(ros1, kind)
    burst.say(1)
    burst.wait_for_the_last()
    assert burst.parts() == list(range(COUNT))
    assert "lost" not in burst.diagnostics()
    assert "messages were lost" not in burst.guard.log


@pytest.mark.long
def test_all_that_a_frozen_subscriber_does_not_take_is_counted_and_told(ros1, kind):
    burst = Burst(ros1, kind)
    burst.reader.tell(signal.SIGSTOP)
    burst.say(LARGE)
    wait_for(lambda: ros1.received(NODE, FLOW) == COUNT, what="all before the guard")
    told = rf"{TOPIC}: messages were lost: \d+ on {OUT}, behind the guard"
    wait_for(lambda: re.search(told, burst.guard.log), what="the word of it")
    burst.reader.tell(signal.SIGCONT)
    burst.wait_for_the_last()
    wait_for(lambda: burst.lost() + len(burst.parts()) == COUNT, what="the count of all")
    assert burst.lost()
