"""What robots show before and after a change, and which of it is a problem. No I/O, no clock."""

from collections.abc import Iterator
from dataclasses import dataclass

from rtron.service.domain.rollouts.states import Problem
from rtron.vocabulary import Alarm, GuardState

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
