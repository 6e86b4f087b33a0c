"""What a server's list of goals says beside what is known of them; sans-I/O."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.policies.goals.registry import Goal, GoalRegistry, GoalStage
from rtron.vocabulary import SECOND, SERVER_FLOW

LOST_TIMEOUT = 2 * SECOND
"""A goal that the server has not listed for so long is not with it any more."""
UNREAD_TIMEOUT = 10 * SECOND
"""The same for one that it has never listed: a busy server has it still to read, and would do it.

actionlib's own clients wait for this without end.
"""
TERMINAL_STATUSES = frozenset({2, 3, 4, 5, 8, 9})
"""The states of a goal that is over (actionlib_msgs/GoalStatus)."""


@dataclass(slots=True)
class GoalChanges:
    """What has changed: goals that were not known, and that are over, and that should not be."""

    discovered: list[Goal] = field(default_factory=list)
    finished: list[Goal] = field(default_factory=list)
    resurrected: list[bytes] = field(default_factory=list)


def compare_status_list(
    goals: GoalRegistry, statuses: Mapping[bytes, int], now: int
) -> GoalChanges:
    """Take the state of each goal as the server lists it.

    Goals that did not come through here are found; those that were answered because the server
    seemed to be gone, and now go on, are astray.
    """
    changes = GoalChanges()
    for id, status in statuses.items():
        if status not in TERMINAL_STATUSES and goals.find(id) is None:
            _handle_unknown(goals, id, now, changes)
    for goal in goals:
        if goal.id in statuses:
            _handle_known(goal, statuses[goal.id], now, changes)
    return changes


def add_discovered_goal(goals: GoalRegistry, id: bytes, now: int, stamp: int = 0) -> Goal:
    """Know of a goal that the server has without having got it here."""
    goal = Goal(id, stamp, SERVER_FLOW, "", stage=GoalStage.SENT, last_seen=now)
    goals.add(goal)
    return goal


def lost_goals(goals: GoalRegistry, reported_at: int) -> list[Goal]:
    """Return the goals that the server had not listed for long at `reported_at` (ns).

    Also those that it lists as over, and whose result does not come.
    """
    sent = (goal for goal in goals if goal.stage is GoalStage.SENT)
    return [goal for goal in sent if reported_at - goal.last_seen >= _timeout(goal)]


def _timeout(goal: Goal) -> int:
    return UNREAD_TIMEOUT if goal.is_unread else LOST_TIMEOUT


def _handle_unknown(goals: GoalRegistry, id: bytes, now: int, changes: GoalChanges) -> None:
    if goals.is_finished(id):
        changes.resurrected.append(id)
    elif not goals.rejection_reason(id, "", now):
        changes.discovered.append(add_discovered_goal(goals, id, now))


def _handle_known(goal: Goal, status: int, now: int, changes: GoalChanges) -> None:
    if goal.status not in TERMINAL_STATUSES:
        goal.last_seen = now
    goal.status, goal.is_unread = status, False
    if status in TERMINAL_STATUSES:
        changes.finished.append(goal)
