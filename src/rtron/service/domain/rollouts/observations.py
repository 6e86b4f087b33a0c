"""What robots show before and after a change, and which of it is a problem. No I/O, no clock."""

from collections.abc import Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rtron.service.domain.rollouts.schemas import Problem, RolloutState
from rtron.vocabulary import SECOND, Alarm, GuardEventLevel, GuardState

MIN_MESSAGES = 20
"""Of fewer messages since the change, the blocked share says nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotBaseline:
    """What a robot showed just before it got a change.

    Messages are counted since the guard began; after the change again, where `is_counted_anew`,
    since another plan needs another guard. `recent` are problems that it had of late without the
    change.
    """

    alarms: frozenset[str] = frozenset()
    blocked: int = 0
    messages: int = 0
    is_stopped: bool = False
    recent: frozenset[Problem] = frozenset()
    is_counted_anew: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Observation:
    """What a robot shows now; `state` is None while its guard is not connected.

    `events` are the problems that stored events since the baseline tell; `missing_since` (ns) is
    since when its guard has been gone, or has not answered.
    """

    state: GuardState | None
    events: frozenset[Problem] = frozenset()
    is_refused: bool = False
    missing_since: int | None = None


def baseline_of(state: GuardState, recent: frozenset[Problem]) -> RobotBaseline:
    """Return what a robot shows in a state."""
    blocked, messages = _counts(state)
    return RobotBaseline(
        alarms=_alarm_keys(state),
        blocked=blocked,
        messages=messages,
        is_stopped=state.stopped,
        recent=recent,
    )


def find_problems(
    before: RobotBaseline, after: Observation, blocked_rise: float, answer_within: int, now: int
) -> frozenset[Problem]:
    """Return what a robot shows at `now` (ns) that it did not show before the change."""
    return frozenset(_problems(before, after, blocked_rise, answer_within, now))


def _problems(
    before: RobotBaseline, after: Observation, blocked_rise: float, answer_within: int, now: int
) -> Iterator[Problem]:
    yield from after.events - before.recent
    if after.is_refused:
        yield Problem.REFUSED
    if after.missing_since is not None and now - after.missing_since >= answer_within:
        yield Problem.GONE
    if after.state is None:
        return
    if not _alarm_keys(after.state) <= before.alarms:
        yield Problem.ALARM
    if after.state.stopped and not before.is_stopped:
        yield Problem.STOPPED
    if _rise(before, after.state) > blocked_rise:
        yield Problem.BLOCKED


def _rise(before: RobotBaseline, state: GuardState) -> float:
    """Return by how much the blocked share is higher than before; 0 where that is not known."""
    blocked, messages = _counts(state)
    share_before = before.blocked / before.messages if before.messages else 0.0
    if not before.is_counted_anew:
        blocked, messages = blocked - before.blocked, messages - before.messages
    return blocked / messages - share_before if messages >= MIN_MESSAGES else 0.0


def _counts(state: GuardState) -> tuple[int, int]:
    """Return how many messages were blocked, of how many, since the guard began."""
    counts = [each for stream in state.streams for each in stream.flows.values()]
    blocked = sum(each.dropped for each in counts)
    return blocked, blocked + sum(each.passed + each.held + each.modified for each in counts)


def _alarm_keys(state: GuardState) -> frozenset[str]:
    return frozenset(map(_alarm_key, state.alarms))


def _alarm_key(alarm: Alarm) -> str:
    return f"{alarm.kind}|{alarm.topic}|{alarm.node}|{alarm.peer}"


ROLLOUT = "rollout"
"""The type of the live message, and the kind of the alert."""
_GOING_BACK = frozenset({RolloutState.REVERTING, RolloutState.REVERTED})
_MAX_LENGTH = 1000


def going_back_alert(id: int, before: RolloutState, state: RolloutState, note: str) -> str:
    """Return that a roll-out which nobody takes back goes back, and why; "" if it does not."""
    if before in _GOING_BACK or state not in _GOING_BACK:
        return ""
    return f"roll-out {id} goes back by itself: {note}"[:_MAX_LENGTH]


def rollout_message(id: int, alert: str = "") -> dict[str, Any]:
    """Return the live message that something of a roll-out is new; `alert` if it is that bad."""
    return {"type": ROLLOUT, "id": id, "alert": alert}


def alert_event(message: Mapping[str, Any], now: int) -> dict[str, Any]:
    """Return an alert at `now` (ns), with the keys of a robot's event; it is of no robot."""
    texts = "robot", "topic", "flow", "publisher", "policy", "decision"
    return {
        **dict.fromkeys(texts, ""),
        "id": 0,
        "at": now,
        "kind": ROLLOUT,
        "node": f"rollout/{message['id']}",
        "level": GuardEventLevel.ERROR.value,
        "reason": message["alert"],
        "revision": 0,
        "values": {},
    }


class RolloutNews:
    """Finds out which roll-outs show something new, each once a second at most; time passed in."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Hashable, int]] = {}

    def is_new(self, id: int, shown: Hashable, now: int) -> bool:
        """Tell whether a roll-out shows something else than when it was new last, at `now` (ns).

        What changes within a second of that is new later, as long as it is looked at.
        """
        before, at = self._known.get(id, (None, now - SECOND))
        if shown == before or abs(now - at) < SECOND:
            return False
        self._known[id] = shown, now
        return True

    def take_ended(self, unfinished: Collection[int]) -> Sequence[int]:
        """Return the roll-outs that have come to an end since the last time: that is new, too."""
        ended = sorted(self._known.keys() - set(unfinished))
        for id in ended:
            del self._known[id]
        return ended
