"""The messages of an action of ROS 2 as CDR: ids in feedback, and the status array, both ways.

A message begins with its encapsulation (4 bytes), which says the byte order; offsets for alignment
count from behind it. Readers raise WireError for what is too short, too long or not plain CDR
(ROS: action_msgs/GoalStatusArray; OMG DDSI-RTPS 2.5, 10.2).
"""

import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rtron.errors import WireError
from rtron.vocabulary import SECOND

UNKNOWN, ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(7)
"""The states of a goal (action_msgs/GoalStatus)."""
FINAL_STATES = frozenset({SUCCEEDED, CANCELED, ABORTED})
MAX_STATUSES = 10_000
"""The longest list of goals that a server may tell, entries."""
ID_SIZE = 16
NO_ID = bytes(ID_SIZE)
"""The id that means every goal, in a cancel."""

_HEAD = 4
_LITTLE = b"\x00\x01\x00\x00"
_COUNT = 4
_STAMP = 8
_LATEST = (1 << 31) * SECOND


class GoalMessage(bytes):
    """A goal as CDR, which knows its id."""

    id: bytes

    @classmethod
    def of(cls, id: bytes, message: bytes) -> "GoalMessage":
        """Return a goal that knows its id."""
        goal = cls(message)
        goal.id = id
        return goal


@dataclass(frozen=True, slots=True)
class GoalStatus:
    """What has become of a goal: its id, when it was accepted (ns), and its state."""

    id: bytes
    stamp: int
    status: int


def feedback_id(message: bytes) -> bytes:
    """Return the id of the goal that a feedback message is about."""
    _byte_order(message)
    if len(message) < _HEAD + ID_SIZE:
        raise WireError(f"a feedback message of {len(message)} bytes")
    return message[_HEAD : _HEAD + ID_SIZE]


def read_statuses(message: bytes) -> list[GoalStatus]:
    """Return what a status array lists."""
    order = _byte_order(message)
    (count,) = _unpacked(order + "I", message, _HEAD)
    if count > MAX_STATUSES:
        raise WireError(f"a status array of {count} goals")
    found, at = [], _HEAD + _COUNT
    for _ in range(count):
        id = message[at : at + ID_SIZE]
        at = _aligned(at + ID_SIZE)
        seconds, nanoseconds, status = _unpacked(order + "iIb", message, at)
        at += _STAMP + 1
        found.append(GoalStatus(id, seconds * SECOND + nanoseconds, status))
    return found


def status_array(goals: Iterable[GoalStatus]) -> bytes:
    """Return a status array that lists goals."""
    listed: Sequence[GoalStatus] = list(goals)
    written = bytearray(_LITTLE + struct.pack("<I", len(listed)))
    for goal in listed:
        written += goal.id
        written += bytes(_aligned(len(written)) - len(written))
        seconds, nanoseconds = divmod(max(0, min(goal.stamp, _LATEST - 1)), SECOND)
        written += struct.pack("<iIb", seconds, nanoseconds, goal.status)
    return bytes(written)


def _byte_order(message: bytes) -> str:
    """Return the byte order that a message says it has."""
    if len(message) < _HEAD or message[0] != 0 or message[1] > 1:
        raise WireError("no plain CDR")
    return "<" if message[1] else ">"


def _unpacked(form: str, message: bytes, at: int) -> tuple[int, ...]:
    try:
        return struct.unpack_from(form, message, at)
    except struct.error:
        raise WireError(f"a message of {len(message)} bytes ends too early") from None


def _aligned(at: int) -> int:
    """Return the next place that is a multiple of 4; the head is 4 itself."""
    return -(-at // 4) * 4
