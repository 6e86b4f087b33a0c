"""Which goal of an action a goal that was given another way has become: the one that appears next.

`move_base_simple/goal` has no goal id; its server gives itself a goal of its own instead.
"""

from collections.abc import Iterable


class Following:
    """Knows the goal that followed what was said last; sans-I/O."""

    def __init__(self) -> None:
        self._expecting = False
        self._seen: frozenset[bytes] = frozenset()
        self.flow = ""
        self.goal: bytes | None = None

    def said(self, flow: str) -> None:
        """Expect a goal: something of `flow` went out."""
        self._expecting, self.flow, self.goal = True, flow, None

    @property
    def expecting(self) -> bool:
        """Whether the goal has not appeared yet."""
        return self._expecting

    def give_up(self) -> None:
        """Expect no goal any more: what was said has become none."""
        self._expecting = False

    def sees(self, ids: Iterable[bytes]) -> None:
        """Take the goals that there are; one that was not there before may be the expected one."""
        seen = frozenset(ids)
        new = sorted(seen - self._seen)
        self._seen = seen
        if new:
            self.appears(new[-1])

    def appears(self, id: bytes) -> None:
        """Take a goal that is new."""
        if self._expecting:
            self._expecting, self.goal = False, id

    def over(self, id: bytes) -> bool:
        """Tell whether the goal that is over is what was said last; it may not have been seen."""
        if id not in self._seen:
            self.appears(id)
        ended = id == self.goal
        self.goal = None if ended else self.goal
        return ended
