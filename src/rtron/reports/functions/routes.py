"""The arrows in the picture of the functions' interaction graph, and those that lead back.

What flows back to an earlier stage runs in a lane above everything.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import TypeAlias

from rtron.functions.graph import Basis, DirectInteraction
from rtron.reports.functions.ground import (
    LANE,
    MARGIN,
    NODE_HEIGHT,
    NODE_WIDTH,
    PAD,
    Box,
    Ground,
)
from rtron.reports.sanitize import neutral

LINE, LETTER, BOLD = 16, 7.9, 8.9
_STEP, _BUNDLE = 5, 10
_Told: TypeAlias = tuple[str, str, Basis]
Words: TypeAlias = tuple[tuple[str, Basis], ...]
"""What is said on an arrow, line by line, and how it is known."""


@dataclass(frozen=True, slots=True)
class Line:
    """An arrow as an SVG path, the functions that it joins, and what is said on it, line by line.

    `through` is what changes in the environment, "" for a direct interaction; `head` tells whether
    it ends in an arrowhead.
    """

    path: str
    sources: tuple[str, ...]
    targets: tuple[str, ...]
    words: Words = ()
    label: Box | None = None
    through: str = ""
    head: bool = True


def is_forward(edge: DirectInteraction, columns: Mapping[str, int]) -> bool:
    """Tell whether an interaction leads to the same column or to a later one."""
    return columns[edge.source] <= columns[edge.target]


def backward(edges: Iterable[DirectInteraction], columns: Mapping[str, int]) -> list[str]:
    """Return the functions with something that flows back to an earlier column."""
    return list(dict.fromkeys(e.source for e in edges if not is_forward(e, columns)))


def lanes(edges: Iterable[DirectInteraction], back: Sequence[str], ground: Ground) -> list[Line]:
    """Return the arrows that lead back; `back` has their functions from the top lane down."""
    told: set[_Told] = set()
    flowing = [edge for edge in edges if not is_forward(edge, ground.columns)]
    return [_lane(edge, back.index(edge.source), ground, told) for edge in flowing]


def _lane(edge: DirectInteraction, lane: int, ground: Ground, told: set[_Told]) -> Line:
    """Return an arrow that leaves to the right, runs back in its lane, and drops to the left."""
    source, target = ground.nodes[edge.source], ground.nodes[edge.target]
    aside = _STEP * (lane % _BUNDLE)
    y = MARGIN + LANE * (lane + 0.8)
    out, down = source.right + _STEP + aside, target.x - PAD - _STEP - aside
    start, end = source.y + NODE_HEIGHT / 4, target.y + NODE_HEIGHT / 4
    path = (
        f"M{right_side(source, start):.0f},{start:.0f} H{out:.0f} V{y:.0f} H{down:.0f} "
        f"V{end:.0f} H{left_side(target, end):.0f}"
    )
    new = [m for m in edge.messages[:2] if (edge.source, m.type, m.basis) not in told]
    told.update((edge.source, m.type, m.basis) for m in new)
    ground.lines += [Box(out, y, 1, start - y), Box(down, y, 1, end - y)]
    words = tuple((neutral(m.type), m.basis) for m in new)
    label = _lane_label(words, down, y, ground) if words else None
    return Line(path, (edge.source,), (edge.target,), words, label)


def _lane_label(words: Words, x: float, y: float, ground: Ground) -> Box:
    """Return the place above a lane, from the left, for types that stand side by side."""
    width = sum(map(text_width, words)) + 2 * LETTER * len(words)
    starts = (x + PAD + 20 * step for step in range(12))
    return ground.place(Box(start, y - LINE - 2, width, LINE) for start in starts)


def text_width(word: tuple[str, Basis]) -> float:
    """Return how wide a line on an arrow is: what is read in source is bold."""
    text, basis = word
    return len(text) * (BOLD if basis is Basis.SOURCE else LETTER)


def right_side(box: Box, y: float) -> float:
    """Return where the right side of a function's ellipse is at a height."""
    off = (y - box.y - NODE_HEIGHT / 2) / (NODE_HEIGHT / 2)
    return box.x + NODE_WIDTH / 2 * (1 + sqrt(max(1 - off * off, 0)))


def left_side(box: Box, y: float) -> float:
    """Return where the left side of a function's ellipse is at a height."""
    return 2 * box.x + NODE_WIDTH - right_side(box, y)
