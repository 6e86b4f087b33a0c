"""Constrain: no velocity above the end user's limit.

## What it does

A velocity above `max_vel_limit` is scaled down to it as a whole, angular part included, so that the
robot follows the same curve more slowly. A value on the topic of a maximal velocity (`max_vel`) is
replaced by the limit. The limit of acceleration holds back only a speed that rises.

NaN, Inf and a negative maximal velocity are dropped. A limit of 0 stops the robot.

## When to use it

Where the surroundings are narrow or full of people. The end user selects it and sets the limit.

## Settings

| setting | of | meaning |
|---|---|---|
| `max_vel_limit` | the RSRCN | the limit, in m/s or with a unit |
| `max_turn_limit` | the RSRCN | the limit of turning, in rad/s (none) |
| `max_side_limit` | the RSRCN | the limit of driving sideways, in m/s (none) |
| `max_accel_limit` | the RSRCN | how fast the speed may rise (m/s2; none) |
| `priority` | each vflow | the higher goes first; all the same: no order |
| `block` | each vflow | the flow's messages are dropped |
| `on_error` | each vflow | what a message that cannot be judged does: `stop` the robot, or `drop` |

## States

A velocity that is exactly at the limit is within it.

## Example

>>> from rtron.policies import build_policy
>>> from rtron.vocabulary import Flow, PolicyName, PolicySettings, StreamKind, Velocity
>>> policy = build_policy(PolicySettings(
...     policy=PolicyName.CONSTRAIN,
...     kind=StreamKind.COMMAND,
...     flows=(Flow(name="vflow1", publisher="/tb3_monitor"),),
...     max_vel_limit=0.22,
... ))
>>> verdict = policy.verdict("vflow1", Velocity((2.0,)), now=0)
>>> print(verdict.decision, verdict.message.speed, "because", verdict.reason)
modify 0.22 because limited to 0.22 m/s (max_vel_limit)
>>> print(policy.verdict("vflow1", Velocity((float("nan"),)), now=0).decision)
drop
"""

from rtron.policies.velocity_limit.frame_monitors import FrameMonitors
from rtron.policies.velocity_limit.limiter import TABLE, VelocityLimiter
from rtron.policies.velocity_limit.speed_limits import FixedLimit
from rtron.vocabulary import PolicySettings

__all__ = ["TABLE", "Constrain"]


class Constrain(VelocityLimiter):
    """At most `max_vel_limit`."""

    def __init__(self, settings: PolicySettings, monitors: FrameMonitors) -> None:  # noqa: ARG002
        super().__init__(settings, FixedLimit(settings))
