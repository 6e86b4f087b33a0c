"""What a server's list of goals says beside what is known of them; sans-I/O."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.policies.goals.registry import Goal, Goals, Where
from rtron.vocabulary import SECOND, SERVER

LOST_AFTER = 2 * SECOND
"""A goal that the server has not listed for so long is not with it any more."""
TERMINAL = frozenset({2, 3, 4, 5, 8, 9})
"""The states of a goal that is over (actionlib_msgs/GoalStatus)."""


@dataclass(slots=True)
class News:
    """What has changed: goals that were not known, and that are over, and that should not be."""

    found: list[Goal] = field(default_factory=list)
    over: list[Goal] = field(default_factory=list)
    astray: list[bytes] = field(default_factory=list)


def compare(goals: Goals, listed: Mapping[bytes, int], now: int) -> News:
    """Take the state of each goal as the server lists it.

    Goals that did not come through here are found; those that were answered because the server
    seemed to be gone, and now go on, are astray.
    """
    news = News()
    for id, status in listed.items():
        if status not in TERMINAL and goals.find(id) is None:
            _unknown(goals, id, now, news)
    for goal in goals:
        if goal.id in listed:
            _known(goal, listed[goal.id], now, news)
    return news


def find(goals: Goals, id: bytes, now: int, stamp: int = 0) -> Goal:
    """Know of a goal that the server has without having got it here."""
    goal = Goal(id, stamp, SERVER, "", where=Where.SENT, seen=now)
    goals.add(goal)
    return goal


def lost(goals: Goals, told: int) -> list[Goal]:
    """Return the goals that the server had not listed for long at `told` (ns).

    Also those that it lists as over, and whose result does not come.
    """
    sent = (goal for goal in goals if goal.where is Where.SENT)
    return [goal for goal in sent if told - goal.seen >= LOST_AFTER]


def _unknown(goals: Goals, id: bytes, now: int, news: News) -> None:
    if goals.is_over(id):
        news.astray.append(id)
    elif not goals.why_not(id, "", now):
        news.found.append(find(goals, id, now))


def _known(goal: Goal, status: int, now: int, news: News) -> None:
    if goal.status not in TERMINAL:
        goal.seen = now
    goal.status = status
    if status in TERMINAL:
        news.over.append(goal)
