"""Safe+Constrain: the lower of two limits, the frame rate's and the end user's.

## What it does

Each message is under the lower limit of Safe and Constrain.

## When to use it

Where the developer's Safe holds at all times and the end user asks for less in some places.

## Settings

| setting | of | meaning |
|---|---|---|
| `threshold` | the RSRCN | metres per frame |
| `lowest` | the RSRCN | the limit while an image node is silent (0 m/s) |
| `max_vel_limit` | the RSRCN | the end user's limit |
| `max_turn_limit`, `max_side_limit`, `max_accel_limit` | the RSRCN | as in Safe |
| `priority`, `block`, `on_error` | each vflow | as in Safe |

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
...     policy=PolicyName.SAFE_CONSTRAIN,
...     kind=StreamKind.COMMAND,
...     flows=(Flow(name="vflow1", publisher="/move_base"),),
...     threshold=0.05,
...     max_vel_limit=0.15,
... ), monitors)
>>> for frame in range(4):
...     monitors.monitors["fps_detector"].add_frame(stamp=frame + 1, now=frame * SECOND // 4)
>>> print(policy.verdict("vflow1", Velocity((0.5,)), now=SECOND * 3 // 4).reason)
limited to 0.15 m/s (max_vel_limit)
>>> print(policy.verdict("vflow1", Velocity((0.5,)), now=2 * SECOND).reason)
nothing moves: 0 m/s (fps_detector is silent)
"""

from rtron.policies.velocity_limit.frame_monitors import FrameMonitors
from rtron.policies.velocity_limit.limiter import TABLE, VelocityLimiter
from rtron.policies.velocity_limit.speed_limits import FixedLimit, FrameRateLimit, LowestLimit
from rtron.vocabulary import PolicySettings

__all__ = ["TABLE", "SafeConstrain"]


class SafeConstrain(VelocityLimiter):
    """At most the lower of Safe's limit and Constrain's."""

    def __init__(self, settings: PolicySettings, monitors: FrameMonitors) -> None:
        super().__init__(
            settings, LowestLimit(FixedLimit(settings), FrameRateLimit(settings, monitors))
        )
