"""A rule that begins to hold while a goal is in progress ends the goal."""

from dataclasses import replace

import pytest
from action_app import ACT, GOAL_TYPE, SERVER, Act, action_plan
from harness import wait_for
from said import say

from rtron.vocabulary import MSRCN, EventFlow, Flow, GuardedTopic, Mode, PolicyName, Rule

pytestmark = pytest.mark.ros1
LONG = 60_000
RED = EventFlow(
    name="red",
    topic="/light",
    publisher="/light",
    type="std_msgs/String",
    when="event.data == 'red'",
)
RULE = Rule(name="light", when="red", block=(f"{ACT}/goal",), reason="the light is red")


def ruled_plan():
    flows = (Flow(name="aflow1", publisher="/one"),)
    topic = GuardedTopic(topic=f"{ACT}/goal", type=GOAL_TYPE, flows=flows, successors=(SERVER,))
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(topic,),
        eflows=(RED,),
        rules=(RULE,),
    )
    return replace(action_plan(PolicyName.FIFO_QUEUE, ("/one",)), msrcn=msrcn)


def show(ros1, light, color):
    """Let the light change its color."""
    if light:
        light.stop()
        wait_for(lambda: not ros1.publishers("/light"), what="the light's end")
    return say(ros1, "light", "/light", "std_msgs/String", color)


def test_a_rule_cancels_the_goal_in_progress_and_refuses_others_while_it_holds(ros1, programs):
    act = Act(ros1, programs, ruled_plan())
    light = show(ros1, None, "green")
    served = act.server("cpp")
    one = act.client(name="/one")
    one.wait_for("connected")
    wait_for(lambda: ros1.received("/rtron/msrcn", "/light"), what="green at the guard")
    one.send(LONG)
    served.wait_for("started")
    one.send(LONG)
    one.wait_for_state(2, "PENDING")
    light = show(ros1, light, "red")
    done = one.done(2)
    assert done[1] == "PREEMPTED"
    assert done[2] in {"REJECTED", "RECALLED"}
    one.send(1)
    assert one.done(3)[3] == "REJECTED"
    assert "the light is red" in one.text(3)
    assert len(served.executed()) == 1
    show(ros1, light, "green")
    heard = ros1.received("/rtron/msrcn", "/light")
    wait_for(lambda: ros1.received("/rtron/msrcn", "/light") > heard, what="green again")
    one.send(1)
    assert one.done(4)[4] == "SUCCEEDED"
