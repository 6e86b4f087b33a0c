"""The messages of an action of ROS 1 as bytes: what actionlib itself reads of them, and no more.

A message begins with its length (4 bytes), as everywhere in ROS 1. Goal ids are bytes: clients
choose them, and they need not be text. Readers raise WireError for what is too short or too long
(ROS: actionlib_msgs).
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass

from rtron.errors import WireError
from rtron.messages.common.encoding import PREFIX
from rtron.vocabulary import SECOND

PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED, PREEMPTING, RECALLING, RECALLED, LOST = (
    range(10)
)
MAX_STATUSES = 10_000
"""The longest list of goals that a server may tell, entries."""

_U32 = struct.Struct("<I")
_STAMP = struct.Struct("<II")
_HEADER = struct.Struct("<III")


@dataclass(frozen=True, slots=True)
class GoalID:
    """A goal's name and stamp (ns); both may be empty."""

    id: bytes
    stamp: int


@dataclass(frozen=True, slots=True)
class GoalStatus:
    """What has become of a goal."""

    goal: GoalID
    status: int
    text: str = ""


def read_goal(message: bytes) -> GoalID:
    """Return the id of an ActionGoal."""
    return _goal_id(message, _after_header(message))[0]


def with_goal_id(message: bytes, goal: GoalID) -> bytes:
    """Return an ActionGoal with another id."""
    at = _after_header(message)
    _, end = _goal_id(message, at)
    return _framed(message[PREFIX:at] + _packed(goal) + message[end:])


def read_cancel(message: bytes) -> GoalID:
    """Return the GoalID that a cancel is."""
    return _goal_id(message, PREFIX)[0]


def cancel_message(id: bytes) -> bytes:
    """Return the cancel of one goal; it has no stamp, since that would mean others too."""
    return _framed(_packed(GoalID(id, 0)))


def read_statuses(message: bytes) -> dict[bytes, int]:
    """Return the state of each goal of a GoalStatusArray, by its id."""
    count, at = _u32(message, _after_header(message))
    if count > MAX_STATUSES:
        raise WireError(f"a status of {count} goals, the most is {MAX_STATUSES}")
    try:
        found, end = _states(message, count, at)
    except (struct.error, IndexError):
        raise WireError("a status array ends too early") from None
    if end > len(message):
        raise WireError("a status array ends too early")
    return found


def stamp_of(message: bytes, id: bytes) -> int:
    """Return the stamp (ns) of a goal that a GoalStatusArray lists."""
    first = _after_header(message) + _U32.size + _STAMP.size
    at = message.find(_string(id), first)
    if at < 0:
        raise WireError("a goal is not listed")
    seconds, nanoseconds = _STAMP.unpack_from(message, at - _STAMP.size)
    return int(seconds) * SECOND + int(nanoseconds)


def _states(message: bytes, count: int, at: int) -> tuple[dict[bytes, int], int]:
    """Return what `count` entries from `at` say, and where they end; not slow for thousands."""
    found: dict[bytes, int] = {}
    length = _U32.unpack_from
    for _ in range(count):
        begin = at + _STAMP.size + _U32.size
        end = begin + length(message, at + _STAMP.size)[0]
        found[message[begin:end]] = message[end]
        at = end + 1 + _U32.size + length(message, end + 1)[0]
    return found, at


def after_header(message: bytes) -> bytes:
    """Return what stands behind a message's header: the same for an array that says the same."""
    return message[_after_header(message) :]


def with_statuses(message: bytes, more: Sequence[GoalStatus]) -> bytes:
    """Return a GoalStatusArray with further entries."""
    if not more:
        return message
    at = _after_header(message)
    count, after = _u32(message, at)
    added = b"".join(map(_packed_status, more))
    return _framed(message[PREFIX:at] + _U32.pack(count + len(more)) + message[after:] + added)


def read_result(message: bytes) -> GoalStatus:
    """Return whose result an ActionResult is, and how the goal ended."""
    return _status(message, _after_header(message))[0]


def result_message(stamp: int, status: GoalStatus, result: bytes) -> bytes:
    """Return an ActionResult of time `stamp` (ns) whose own fields are the bytes `result`."""
    seconds, rest = divmod(stamp, SECOND)
    header = _HEADER.pack(0, seconds % (1 << 32), rest) + _string(b"")
    return _framed(header + _packed_status(status) + result)


def _after_header(message: bytes) -> int:
    return _string_end(message, PREFIX + _HEADER.size)


def _goal_id(message: bytes, at: int) -> tuple[GoalID, int]:
    try:
        seconds, nanoseconds = _STAMP.unpack_from(message, at)
    except struct.error:
        raise WireError("a goal id is missing") from None
    end = _string_end(message, at + _STAMP.size)
    id = message[at + _STAMP.size + _U32.size : end]
    return GoalID(id, seconds * SECOND + nanoseconds), end


def _status(message: bytes, at: int) -> tuple[GoalStatus, int]:
    goal, at = _goal_id(message, at)
    end = _string_end(message, at + 1)
    return GoalStatus(goal, message[at]), end


def _string_end(message: bytes, at: int) -> int:
    length, begin = _u32(message, at)
    if begin + length > len(message):
        raise WireError("a text ends behind its message")
    return begin + length


def _u32(message: bytes, at: int) -> tuple[int, int]:
    try:
        return _U32.unpack_from(message, at)[0], at + _U32.size
    except struct.error:
        raise WireError("a message ends too early") from None


def _packed(goal: GoalID) -> bytes:
    return _STAMP.pack(*divmod(goal.stamp, SECOND)) + _string(goal.id)


def _packed_status(status: GoalStatus) -> bytes:
    text = status.text.encode(errors="replace")
    return _packed(status.goal) + bytes([status.status]) + _string(text)


def _string(text: bytes) -> bytes:
    return _U32.pack(len(text)) + text


def _framed(body: bytes) -> bytes:
    return _U32.pack(len(body)) + body
