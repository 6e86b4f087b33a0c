"""What the base heard during the soak: whose commands, and the gaps between them."""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from rtron.vocabulary import SECOND

LONGEST_GAP = SECOND // 10
"""How long a base that moves may hear nothing, ns."""
_SETTLED = SECOND
"""How long (ns) the navigation has spoken before a lower flow's command counts as out of turn."""
_LONGEST_SPAN = 100 * SECOND
_RECENT = 3 * SECOND // 10


@dataclass(frozen=True, slots=True)
class Command:
    """A command that came at a time (ns of the steady clock), m/s and rad/s.

    The joystick's drive sideways, too; others turn (`bench/soak/names.py`).
    """

    at: int
    forward: float
    side: float = 0.0
    turn: float = 0.0

    @property
    def speed(self) -> float:
        """How fast the base drives, m/s."""
        return math.hypot(self.forward, self.side)

    @property
    def is_strangers(self) -> bool:
        """Whether it is of who is not in the plan and speaks to the guard."""
        return self.turn > 0

    @property
    def is_intruders(self) -> bool:
        """Whether it is of who goes past the guard."""
        return self.turn < 0


@dataclass(frozen=True, slots=True)
class Span:
    """A time that began at `at` and lasted for `length`, ns."""

    at: int
    length: int

    @property
    def end(self) -> int:
        """When it was over."""
        return self.at + self.length

    def overlap(self, other: "Span") -> int:
        """Return how long both lasted at once, ns."""
        return max(0, min(self.end, other.end) - max(self.at, other.at))


@dataclass(frozen=True, slots=True)
class BaseLog:
    """What the navigation demanded, and what the base heard, each in order.

    `stalls` are the times in which the base itself did not run.
    """

    inputs: Sequence[Command]
    outputs: Sequence[Command]
    stalls: Sequence[Span] = ()

    @classmethod
    def read(cls, path: Path, last: int = 0) -> "BaseLog":
        """Read a file whose lines are `in` or `out`, a time and three speeds; the last may be cut.

        A line with `stall` has a time and a duration, s. With `last`, only so many bytes are read.
        """
        whole, _, _ = path.read_text("utf-8").rpartition("\n")
        text = whole[-last:].partition("\n")[2] if last and len(whole) > last else whole
        rows = [line.split() for line in text.splitlines()]
        sides: dict[str, list[Command]] = {"in": [], "out": [], "stall": []}
        for side, at, *speeds in rows:
            sides[side].append(Command(int(at), *map(float, speeds)))
        stalls = [Span(each.at, int(each.forward * SECOND)) for each in sides["stall"]]
        return cls(sides["in"], sides["out"], stalls)

    def unguarded(self) -> list[Command]:
        """Return the commands of who is not in the plan that came through the guard."""
        return [each for each in self.outputs if each.is_strangers]

    def guarded(self) -> list[Command]:
        """Return the commands that the guard let go."""
        return [each for each in self.outputs if not each.is_intruders]

    def unexplained_gaps(self) -> list[Span]:
        """Return the gaps after which a base that moved heard again, while the navigation spoke.

        A base that was told to rest, or whose last word is an intruder's, waits for nobody. Where
        the navigation was silent as long, or the base did not run, it is not the guard's gap.
        """
        return [gap for gap in self._gaps_with_input() if gap.length > LONGEST_GAP]

    def longest_gap(self) -> int:
        """Return the longest gap of a base that moves while the navigation speaks, ns."""
        return max((gap.length for gap in self._gaps_with_input()), default=0)

    def describe(self, gap: Span) -> str:
        """Tell what was demanded during a gap and what came at its end."""
        end = next((each.at for each in self.outputs if each.at > gap.at), gap.at + gap.length)
        demanded = sum(gap.at < each.at < end for each in self.inputs)
        came = sum(0 <= each.at - end < SECOND // 50 for each in self.outputs)
        return f"the navigation said {demanded} in it, {came} came within 20 ms after it"

    def longest_rest(self, explained: Sequence[Span] = ()) -> int:
        """Return for how long (ns) the base was at rest at most, without the explained times.

        The last rest ends with the log: a guard that has stopped the base and is gone for good lets
        it rest until then.
        """
        moving = [each.at for each in self.guarded() if each.speed]
        rests = (Span(before, after - before) for before, after in pairwise([*moving, self._end()]))
        return max((each.length - _overlap(each, explained) for each in rests), default=0)

    def longest_turn_of_lower_flow(self) -> int:
        """Return for how long (ns) the joystick drove at most although the navigation spoke."""
        longest, begin = 0, None
        for command in self.guarded():
            if not (command.side and self._is_navigation_there(command.at)):
                begin = None
                continue
            begin = command.at if begin is None else begin
            longest = max(longest, command.at - begin)
        return longest

    def duration(self) -> int:
        """Return how long (ns) the base heard anybody, from the first word to the last."""
        begin = min((each.at for each in (*self.inputs[:1], *self.outputs[:1])), default=0)
        return self._end() - begin

    def moving_share(self) -> float:
        """Return for which share of its commands the guard let the base move."""
        guarded = self.guarded()
        return sum(each.speed > 0 for each in guarded) / max(1, len(guarded))

    def intruder_share(self, intrusions: Sequence[Span]) -> float:
        """Return for which share of the time an intruder's was the last word while it was there."""
        spoken = [each for each in map(self._spoken, intrusions) if each.length]
        held = (Span(a.at, b.at - a.at) for a, b in pairwise(self.outputs) if a.is_intruders)
        total = sum(each.length for each in spoken)
        return sum(_overlap(each, spoken) for each in held) / total if total else 0.0

    def time_to_stop(self, intrusion: Span) -> int:
        """Return how long (ns) an intruder spoke before the guard told the base to rest.

        Where the guard never did, it is the time to the end of the log.
        """
        spoken = self._spoken(intrusion)
        if not spoken.length:
            return 0
        begin = bisect_left(self.outputs, spoken.at, key=_at)
        rests = (each.at for each in self.outputs[begin:] if not each.speed)
        stopped = next(rests, None)
        if stopped is None:
            return self._end() - spoken.at
        return min(stopped - spoken.at, spoken.length)

    def _end(self) -> int:
        """Return when the base heard the navigation or anybody else for the last time, ns."""
        return max((each.at for each in (*self.inputs[-1:], *self.outputs[-1:])), default=0)

    def _spoken(self, intrusion: Span) -> Span:
        """Return the time from an intruder's first command to its end."""
        begin, end = intrusion.at, intrusion.at + intrusion.length
        found = self.outputs[bisect_left(self.outputs, begin, key=_at) :]
        first = next((each.at for each in found if each.is_intruders), end)
        return Span(min(first, end), max(0, end - first))

    def _input_times(self, after: int, before: int) -> list[int]:
        """Return when the navigation spoke between two times, ns."""
        begin = bisect_right(self.inputs, after, key=_at)
        end = bisect_left(self.inputs, before, key=_at)
        return [each.at for each in self.inputs[begin:end]]

    def _is_navigation_there(self, now: int) -> bool:
        """Tell whether the navigation speaks at a time, and has for a while."""
        times = [now - _SETTLED, *self._input_times(now - _SETTLED, now), now]
        return max(after - before for before, after in pairwise(times)) < _RECENT

    def _gaps(self) -> Iterator[Span]:
        last = self.inputs[-1:]  # what was demanded to the end tells how long nothing came
        for before, after in pairwise([*self.outputs, *last]):
            if before.speed and not before.is_intruders:
                yield Span(before.at, after.at - before.at)

    def _gaps_with_input(self) -> Iterator[Span]:
        """Yield the gaps, without the time in which the base did not run, where others spoke."""
        for gap in self._gaps():
            if self._has_input(gap):
                yield replace(gap, length=gap.length - _overlap(gap, self.stalls))

    def _has_input(self, gap: Span) -> bool:
        """Tell whether the navigation was heard during a gap, without such a gap of its own."""
        begin, end = gap.at, gap.at + gap.length
        times = [begin, *self._input_times(begin, end), end]
        longest = max(after - before for before, after in pairwise(times))
        return longest < max(gap.length / 2, LONGEST_GAP)


def _overlap(span: Span, others: Sequence[Span]) -> int:
    """Return how long (ns) others, one after the other, lasted within a span."""
    end = bisect_left(others, span.at + span.length, key=lambda each: each.at)
    begin = bisect_left(others, span.at - _LONGEST_SPAN, key=lambda each: each.at)
    return sum(span.overlap(each) for each in others[begin:end])


def _at(command: Command) -> int:
    return command.at
