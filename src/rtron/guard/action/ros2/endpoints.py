"""What the guard and the middleware tell each other of an action of ROS 2.

Ids are the 16 bytes of a goal's UUID, stamps ns of the wall clock, states those of
action_msgs/GoalStatus; goals are CDR, results whatever the middleware hands over, unchanged.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from rtron.messages.ros2.actions import GoalMessage

if TYPE_CHECKING:
    from rtron.guard.replay.recorded_actions import RecordedAction
    from rtron.guard.transport.ros2.action_relay import ActionRelay

MAX_PENDING_RESULTS = 8
"""So many requests for one goal's result wait for it."""


DecodeGoal = Callable[[], GoalMessage]
"""Reads a goal that was sent; WireError if it is none."""
GoalReply = Callable[[int | None], None]
"""Takes since when a goal is accepted, None if it is rejected."""


@dataclass(frozen=True, slots=True)
class CancelResponse:
    """The answer to a cancel: a code of action_msgs/CancelGoal, and the goals that will end."""

    code: int
    goals: Sequence[tuple[bytes, int]] = ()


NONE, REJECTED, UNKNOWN_GOAL, TERMINATED = range(4)
"""The codes."""
CancelReply = Callable[[CancelResponse], None]

ActionEndpoints: TypeAlias = "ActionRelay | RecordedAction"
"""The services and topics of one action: towards its clients, and towards its server."""
