"""What became of the planner's goals, and whose goals the dock worked on."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.soak.names import FORBIDDEN_GOAL
from rtron.vocabulary import SECOND

ENDS = ("succeeded", "canceled", "aborted", "rejected", "recalled", "lost")
_BEFORE, _AFTER = 2 * SECOND, 8 * SECOND


@dataclass(frozen=True, slots=True)
class Goal:
    """A goal: when it was sent (ns), and the words that were written of it."""

    sent: int
    words: tuple[str, ...]

    @property
    def end(self) -> str:
        """How it ended, "" if it has not."""
        return self.words[-1] if self.words[-1] in ENDS else ""

    @property
    def is_lost(self) -> bool:
        """Whether it was accepted and never got an answer."""
        return self.end == "lost" and "accepted" in self.words

    @property
    def is_ignored(self) -> bool:
        """Whether it was neither accepted nor answered."""
        return self.end == "lost" and "accepted" not in self.words

    @property
    def is_canceled_by_others(self) -> bool:
        """Whether it ended as canceled though its client did not cancel it."""
        return self.end == "canceled" and "cancel" not in self.words


def read_goals(path: Path) -> list[Goal]:
    """Read a planner's file, whose lines are a time, a goal's number and a word."""
    text = path.read_text("utf-8")
    goals: dict[str, Goal] = {}
    for line in text[: text.rfind("\n") + 1].splitlines():
        at, number, word = line.split()
        before = goals.get(number, Goal(int(at), ()))
        goals[number] = Goal(before.sent, (*before.words, word))
    return list(goals.values())


def count_ends(goals: Iterable[Goal]) -> Counter[str]:
    """Count how goals ended."""
    return Counter(goal.end for goal in goals if goal.end)


def unexplained(goals: Iterable[Goal], faults: Sequence[int]) -> list[Goal]:
    """Return the ignored goals near whose sending no fault (ns) kept the guard from its work."""
    return [
        goal
        for goal in goals
        if goal.is_ignored and not any(at - _BEFORE < goal.sent < at + _AFTER for at in faults)
    ]


def count_forbidden(started: Iterable[Sequence[int]]) -> int:
    """Count the goals of who is not in the plan that the dock worked on, of times and goals."""
    return sum(goal == FORBIDDEN_GOAL for _, goal in started)
