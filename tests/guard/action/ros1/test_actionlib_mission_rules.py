"""A rule that begins to hold while a goal is in progress ends the goal."""

import pytest
from action_app import ACT, Act, action_plan
from traffic_light import Light, ruled

from rtron.vocabulary import PolicyName

pytestmark = pytest.mark.ros1
LONG = 60_000


def test_a_rule_cancels_the_goal_in_progress_and_refuses_others_while_it_holds(ros1, programs):
    plan = ruled(action_plan(PolicyName.FIFO_QUEUE, ("/one",)), f"{ACT}/goal")
    act = Act(ros1, programs, plan)
    light = Light(ros1, "green")
    served = act.server("cpp")
    one = act.client(name="/one")
    one.wait_for("connected")
    one.send(LONG)
    served.wait_for("started")
    one.send(LONG)
    one.wait_for_state(2, "PENDING")
    light.turn("red")
    done = one.done(2)
    assert done[1] == "PREEMPTED"
    assert done[2] in {"REJECTED", "RECALLED"}
    one.send(1)
    assert one.done(3)[3] == "REJECTED"
    assert "the light is red" in one.text(3)
    assert len(served.executed()) == 1
    light.turn("green")
    one.send(1)
    assert one.done(4)[4] == "SUCCEEDED"
