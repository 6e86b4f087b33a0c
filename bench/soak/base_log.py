"""What the base heard during the soak, and what of it must not be."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from bench.soak.node import FORBIDDEN, INTRUDING, SPEED
from rtron.vocabulary import SECOND

LONGEST_GAP = SECOND // 10
"""How long a base that moves may hear nothing, ns."""


@dataclass(frozen=True, slots=True)
class Command:
    """A command that came at a time (ns of the steady clock), m/s."""

    at: int
    speed: float


@dataclass(frozen=True, slots=True)
class Gap:
    """How long (ns) the base heard nothing after `at` although it moved."""

    at: int
    length: int


@dataclass(frozen=True, slots=True)
class BaseLog:
    """What the navigation said, and what the base was told, each in order."""

    inputs: Sequence[Command]
    outputs: Sequence[Command]

    @classmethod
    def read(cls, path: Path) -> "BaseLog":
        """Read a file with `in` or `out`, a time and a speed on each line; the last may be cut."""
        text = path.read_text("utf-8")
        rows = [line.split() for line in text[: text.rfind("\n") + 1].splitlines()]
        sides: dict[str, list[Command]] = {"in": [], "out": []}
        for side, at, speed in rows:
            sides[side].append(Command(int(at), float(speed)))
        return cls([each for each in sides["in"] if each.speed == SPEED], sides["out"])

    def unguarded(self) -> list[Command]:
        """Return the commands of who is not in the plan that came through the guard."""
        return [each for each in self.outputs if each.speed >= FORBIDDEN]

    def unexplained_gaps(self) -> list[Gap]:
        """Return the gaps after which a base that moved heard again, while the navigation spoke.

        A base that was told to rest, or whose last word is an intruder's, waits for nobody. Where
        the navigation was silent as long, or the base stood still, it is not the guard's gap.
        """
        return [gap for gap in self._gaps() if gap.length > LONGEST_GAP and self._has_input(gap)]

    def longest_gap(self) -> int:
        """Return the longest gap of a base that moves while the navigation speaks, ns."""
        return max((gap.length for gap in self._gaps() if self._has_input(gap)), default=0)

    def longest_rest(self) -> int:
        """Return for how long (ns) the base was at rest at most."""
        moving = [each.at for each in self.outputs if each.speed == SPEED]
        return max((after - before for before, after in pairwise(moving)), default=0)

    def share(self, speed: float) -> float:
        """Return for which share of the time a speed was the base's last word."""
        if len(self.outputs) < 2:
            return 0.0
        total = self.outputs[-1].at - self.outputs[0].at
        held = sum(b.at - a.at for a, b in pairwise(self.outputs) if a.speed == speed)
        return held / total

    def _gaps(self) -> Iterator[Gap]:
        last = self.inputs[
            -1:
        ]  # what was heard to the end tells how long the base was told nothing
        for before, after in pairwise([*self.outputs, *last]):
            if before.speed not in (0.0, INTRUDING):
                yield Gap(before.at, after.at - before.at)

    def _has_input(self, gap: Gap) -> bool:
        """Tell whether the navigation was heard during a gap, without such a gap of its own."""
        begin, end = gap.at, gap.at + gap.length
        times = [begin, *(each.at for each in self.inputs if begin < each.at < end), end]
        return max(after - before for before, after in pairwise(times)) < max(
            gap.length / 2, LONGEST_GAP
        )
