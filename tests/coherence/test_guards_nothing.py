"""A plan guards something as soon as one of its coordination nodes stands in a flow."""

import pytest

from rtron.coherence.flows import guards_nothing
from rtron.planning import parse_plan

PLAN = """\
schema: rtron.plan/1
app: small
ros: 1
grcn:
  - topic: /cmd_vel
    mode: {first}
    policy: Preemption
    type: geometry_msgs/Twist
    flows: [{{name: nav, publisher: /nav, priority: 1}}]
    successors: [/base]
  - topic: /arm
    mode: {second}
    policy: Preemption
    type: geometry_msgs/Twist
    flows: [{{name: pick, publisher: /pick, priority: 1}}]
    successors: [/arm_driver]
"""


@pytest.mark.parametrize(
    ("first", "second", "is_nothing"),
    [
        ("enforce", "enforce", False),
        ("observe", "enforce", False),
        ("enforce", "observe", False),
        ("observe", "observe", True),
    ],
)
def test_what_only_observes_guards_nothing(first, second, is_nothing):
    assert guards_nothing(parse_plan(PLAN.format(first=first, second=second))) == is_nothing


def test_a_plan_without_coordination_nodes_guards_nothing():
    assert guards_nothing(parse_plan("schema: rtron.plan/1\napp: small\nros: 1\n"))
