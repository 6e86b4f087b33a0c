"""Whether the base heard what the policies allow, from what the camera and the detector wrote."""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.soak.base_log import Command
from bench.soak.plan import LOWEST, MAX_SPEED, THRESHOLD
from rtron.vocabulary import SECOND

_WINDOW = SECOND
_STALE = SECOND // 2
_ON_THE_WAY = 3 * SECOND // 20
"""How old a frame rate may be that the guard knows, and how long a message is on its way, ns."""


def rows(path: Path) -> list[list[int]]:
    """Read a file of numbers, a list a line; the last line may be cut."""
    text = path.read_text("utf-8")
    whole = text[: text.rfind("\n") + 1]
    return [[int(word) for word in line.split()] for line in whole.splitlines()]


@dataclass(frozen=True, slots=True)
class SpeedCheck:
    """Compares commands with the pictures that were made, `frames` (ns), in order.

    The guard may still act on a rate that is `_STALE` old. Pictures arrive early and late, so one
    more may be in a window than were made in it.
    """

    frames: Sequence[int]

    def over_limit(self, commands: Sequence[Command]) -> list[Command]:
        """Return the commands that were faster than any rate allowed of late."""
        return [each for each in commands if each.speed > 1.001 * self.allowed(each.at)]

    def allowed(self, now: int) -> float:
        """Return the highest speed that the frame rate allowed a moment before `now`, m/s."""
        begin = now - _STALE - _ON_THE_WAY
        ends = self.frames[bisect_left(self.frames, begin) : bisect_right(self.frames, now)]
        most = max(self._count(end) for end in [begin, *ends])
        rate = (most + 1) * SECOND / _WINDOW if most else 0.0
        return min(MAX_SPEED, max(LOWEST, THRESHOLD * rate))

    def _count(self, end: int) -> int:
        """Return how many pictures were made in the window before `end`, that one included."""
        return bisect_right(self.frames, end) - bisect_right(self.frames, end - _WINDOW)


@dataclass(frozen=True, slots=True)
class Block:
    """A time in which the mission's rule blocked, from the detector's first word to its last."""

    begin: int
    end: int


def blocks(words: Sequence[Sequence[int]]) -> Iterator[Block]:
    """Yield the times in which a person was there, of the detector's times and bits."""
    begin = None
    for at, bit in words:
        if bit and begin is None:
            begin = at
        elif not bit and begin is not None:
            yield Block(begin, at)
            begin = None
    if begin is not None:
        yield Block(begin, words[-1][0])


def longest_drive(block: Block, commands: Sequence[Command]) -> int:
    """Return how long (ns) after a rule began to block a command still moved the base."""
    begin = bisect_left(commands, block.begin, key=lambda each: each.at)
    moved = 0
    for command in commands[begin:]:
        if command.at >= block.end:
            break
        moved = command.at - block.begin if command.speed else moved
    return moved
