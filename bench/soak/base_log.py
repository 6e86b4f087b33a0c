"""What the base heard during the soak, and what of it must not be."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
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
    """What the navigation said, and what the base was told, each in order.

    `stalls` are the times in which the base itself did not run.
    """

    inputs: Sequence[Command]
    outputs: Sequence[Command]
    stalls: Sequence[Gap] = ()

    @classmethod
    def read(cls, path: Path) -> "BaseLog":
        """Read a file with `in` or `out`, a time and a speed on each line; the last may be cut.

        A line with `stall` has a time and a duration, s.
        """
        text = path.read_text("utf-8")
        rows = [line.split() for line in text[: text.rfind("\n") + 1].splitlines()]
        sides: dict[str, list[Command]] = {"in": [], "out": []}
        stalls = [Gap(int(at), int(float(s) * SECOND)) for side, at, s in rows if side == "stall"]
        for side, at, speed in rows:
            if side != "stall":
                sides[side].append(Command(int(at), float(speed)))
        return cls([each for each in sides["in"] if each.speed == SPEED], sides["out"], stalls)

    def unguarded(self) -> list[Command]:
        """Return the commands of who is not in the plan that came through the guard."""
        return [each for each in self.outputs if each.speed >= FORBIDDEN]

    def unexplained_gaps(self) -> list[Gap]:
        """Return the gaps after which a base that moved heard again, while the navigation spoke.

        A base that was told to rest, or whose last word is an intruder's, waits for nobody. Where
        the navigation was silent as long, or the base did not run, it is not the guard's gap.
        """
        return [gap for gap in self._gaps_with_input() if gap.length > LONGEST_GAP]

    def longest_gap(self) -> int:
        """Return the longest gap of a base that moves while the navigation speaks, ns."""
        return max((gap.length for gap in self._gaps_with_input()), default=0)

    def describe(self, gap: Gap) -> str:
        """Tell what was said during a gap and what came at its end."""
        end = next((each.at for each in self.outputs if each.at > gap.at), gap.at + gap.length)
        said = sum(gap.at < each.at < end for each in self.inputs)
        came = sum(0 <= each.at - end < SECOND // 50 for each in self.outputs)
        return f"the navigation said {said} in it, {came} came within 20 ms after it"

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

    def _gaps_with_input(self) -> Iterator[Gap]:
        """Yield the gaps, without the time in which the base did not run, where others spoke."""
        for gap in self._gaps():
            if self._has_input(gap):
                yield replace(gap, length=gap.length - self._stalled(gap))

    def _stalled(self, gap: Gap) -> int:
        ends = ((max(each.at, gap.at), each.at + each.length) for each in self.stalls)
        return sum(max(0, min(end, gap.at + gap.length) - begin) for begin, end in ends)

    def _has_input(self, gap: Gap) -> bool:
        """Tell whether the navigation was heard during a gap, without such a gap of its own."""
        begin, end = gap.at, gap.at + gap.length
        times = [begin, *(each.at for each in self.inputs if begin < each.at < end), end]
        return max(after - before for before, after in pairwise(times)) < max(
            gap.length / 2, LONGEST_GAP
        )
