"""Safe: no velocity above what the robot's image nodes can follow.

## What it does

The limit is `threshold` x fps: the metres that the robot may drive from one frame to the next,
times the frames a second that its slowest image node processes. A velocity above it is scaled down
as a whole, angular part included. On the topic of a maximal velocity the last value goes out again
when the limit changes, ten times a second at most.

The fps_monitors measure the rate in a sliding window. A late frame lowers the limit at once. The
limit rises by `max_accel_limit` (0.5 m/s2 if the plan has none), after the gap has left the window.
While an image node is silent the limit is `lowest`, by default 0: the robot stops.

## When to use it

Always where a robot must see what is in its way. The developer sets the threshold.

## Settings

| setting | of | meaning |
|---|---|---|
| `threshold` | the RSRCN | metres per frame |
| `lowest` | the RSRCN | the limit while an image node is silent, or before it speaks (0 m/s) |
| `max_turn_limit` | the RSRCN | the limit of turning, in rad/s (none) |
| `max_side_limit` | the RSRCN | the limit of driving sideways, in m/s (none) |
| `max_accel_limit` | the RSRCN | how fast the speed may rise, in m/s2 (none), and the limit (0.5) |
| `window` | each fps_monitor | what the rate is measured over (1 s) |
| `silent_after` | each fps_monitor | the time without a frame after which it is silent (1 s) |
| `priority` | each vflow | the higher goes first; all the same: no order |
| `block` | each vflow | the flow's messages are dropped |
| `on_error` | each vflow | what a message that cannot be judged does: `stop` the robot, or `drop` |

## States

A velocity that is exactly at the limit is within it.

## Example

>>> from rtron.policies import FrameMonitors, build_policy
>>> from rtron.vocabulary import (
...     SECOND, Flow, FpsMonitor, PolicyName, PolicySettings, StreamKind, Velocity
... )
>>> detector = FpsMonitor(id="fps_detector", node="/detector", topic="/detector/image")
>>> monitors = FrameMonitors([detector])
>>> policy = build_policy(PolicySettings(
...     policy=PolicyName.SAFE,
...     kind=StreamKind.COMMAND,
...     flows=(Flow(name="vflow1", publisher="/move_base"),),
...     threshold=0.05,
... ), monitors)
>>> print(policy.verdict("vflow1", Velocity((0.5,), (0.25,)), now=0).reason)
nothing moves: 0 m/s (fps_detector is silent)
>>> for frame in range(4):
...     monitors.monitors["fps_detector"].add_frame(stamp=frame + 1, now=frame * SECOND // 4)
>>> verdict = policy.verdict("vflow1", Velocity((0.5,), (0.25,)), now=SECOND * 3 // 4)
>>> print(verdict.message, "because", verdict.reason)
Velocity(linear=(0.2,), angular=(0.1,)) because limited to 0.2 m/s (fps_detector: 4.0 fps x 0.05 m)
"""

from rtron.policies.velocity_limit.frame_monitors import FrameMonitors
from rtron.policies.velocity_limit.limiter import TABLE, VelocityLimiter
from rtron.policies.velocity_limit.speed_limits import FrameRateLimit
from rtron.vocabulary import PolicySettings

__all__ = ["TABLE", "Safe"]


class Safe(VelocityLimiter):
    """At most `threshold` x fps."""

    def __init__(self, settings: PolicySettings, monitors: FrameMonitors) -> None:
        super().__init__(settings, FrameRateLimit(settings, monitors))
