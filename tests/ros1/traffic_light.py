"""A traffic light, and the mission's rule that while it is red a topic is blocked."""

from dataclasses import replace

from harness import wait_for
from rostopic import say

from rtron.vocabulary import MSRCN, SECOND, EventFlow, GuardedTopic, MissionRule, Mode, PolicyName

LIGHT = "/light"
MSRCN_NODE = "/rtron/msrcn"
RED = EventFlow(
    name="red",
    topic=LIGHT,
    publisher=LIGHT,
    type="std_msgs/String",
    when="event.data == 'red'",
    max_age=30 * SECOND,
)


def ruled(plan, topic):
    """Return a plan under which the red light blocks a topic that a GRCN guards."""
    guarded = next(node for node in plan.grcn if node.topic == topic)
    blocked = GuardedTopic(
        topic=topic, type=guarded.type, flows=guarded.flows, successors=guarded.successors
    )
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(blocked,),
        eflows=(RED,),
        rules=(MissionRule(name="light", when="red", block=(topic,), reason="the light is red"),),
    )
    return replace(plan, msrcn=msrcn)


class Light:
    """The light; it shows a color once the guard has seen it."""

    def __init__(self, ros1, color):
        self._ros1, self._process = ros1, None
        self.turn(color)

    def turn(self, color):
        if self._process:
            self._process.stop()
            wait_for(lambda: not self._ros1.publishers(LIGHT), what="the light's end")
            wait_for(lambda: not self._heard(), what="the light's end at the guard")
        self._process = say(self._ros1, "light", LIGHT, RED.type, color)
        wait_for(self._heard, what=f"{color} at the guard")

    def _heard(self):
        """Return how much the guard has heard of the light that is connected now.

        The node of the MSRCN hears events where the guard is one process.
        """
        nodes = (MSRCN_NODE, f"{MSRCN_NODE}_events")
        return sum(self._ros1.received(node, LIGHT) for node in nodes)
