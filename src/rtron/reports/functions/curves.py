"""The curves in the picture of the functions' interaction graph: what flows to a later stage.

A curve leads around the functions that stand between its ends.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TypeAlias

from rtron.functions.graph import DirectInteraction
from rtron.reports.functions.ground import (
    NODE_HEIGHT,
    NODE_WIDTH,
    Box,
    Ground,
    left_of,
)
from rtron.reports.functions.labels import label_lines
from rtron.reports.functions.routes import (
    LINE,
    Line,
    Words,
    left_side,
    right_side,
    text_width,
)

_SPOTS = (0.5, 0.44, 0.56, 0.38, 0.62, 0.32, 0.68, 0.26, 0.74, 0.2, 0.8, 0.14, 0.86)
_OFFSETS = (0, -0.25, 0.25, -0.5, 0.5, -0.8, 0.8)
_AROUND, _APART = 8, 7
_Point: TypeAlias = tuple[float, float]
_Bend: TypeAlias = tuple[_Point, _Point, _Point, _Point]
_Ports: TypeAlias = Mapping[tuple[str, str, bool], float]


def curves(edges: Sequence[DirectInteraction], ground: Ground) -> list[Line]:
    """Return the arrows to the same column or a later one, and place their labels: large first."""
    ports = _ports(edges, ground)
    bends = {(e.source, e.target): _bends(e, ports, ground) for e in edges}
    ordered = sorted(edges, key=lambda edge: -len(label_lines(edge)))
    return [_line(edge, bends[edge.source, edge.target], ground) for edge in ordered]


def _ports(edges: Iterable[DirectInteraction], ground: Ground) -> _Ports:
    """Return how high on its function's side each arrow starts (True) and ends: all apart."""
    sides: dict[tuple[str, bool], list[tuple[float, bool, DirectInteraction]]] = defaultdict(list)
    for edge in edges:
        turns_back = ground.columns[edge.source] == ground.columns[edge.target]
        sides[edge.source, True].append((ground.nodes[edge.target].y, True, edge))
        sides[edge.target, turns_back].append((ground.nodes[edge.source].y, False, edge))
    heights = {}
    for (name, _), its in sides.items():
        for number, (_, starts, edge) in enumerate(sorted(its, key=lambda each: each[:2])):
            step = NODE_HEIGHT * (0.1 + 0.8 * (number + 1) / (len(its) + 1))
            heights[edge.source, edge.target, starts] = ground.nodes[name].y + step
    return heights


def _line(edge: DirectInteraction, bends: Sequence[_Bend], ground: Ground) -> Line:
    words = label_lines(edge)
    label = ground.place(_label_spots(bends, words))
    path = "M{:.0f},{:.0f}".format(*bends[0][0])
    for _, *rest in bends:
        path += " C" + " ".join(f"{x:.0f},{y:.0f}" for x, y in rest)
    return Line(path, (edge.source,), (edge.target,), words, label)


def _bends(edge: DirectInteraction, ports: _Ports, ground: Ground) -> list[_Bend]:
    first, last = (ports[edge.source, edge.target, starts] for starts in (True, False))
    source, target = ground.nodes[edge.source], ground.nodes[edge.target]
    start = (right_side(source, first), first)
    if ground.columns[edge.source] == ground.columns[edge.target]:
        end = (right_side(target, last), last)
        pull = 46 + abs(end[1] - start[1]) / 6
        return [(start, (start[0] + pull, start[1]), (end[0] + pull, end[1]), end)]
    end = (left_side(target, last), last)
    straight = _bend(start, end)
    between = range(ground.columns[edge.source] + 1, ground.columns[edge.target])
    if not any(_meets(straight, column, ground) for column in between):
        return [straight]
    return [_bend(*ends) for ends in pairwise((start, *_around(straight, between, ground), end))]


def _bend(start: _Point, end: _Point) -> _Bend:
    pull = (end[0] - start[0]) * 0.45
    return start, (start[0] + pull, start[1]), (end[0] - pull, end[1]), end


def _meets(bend: _Bend, column: int, ground: Ground) -> bool:
    """Tell whether a curve runs over a function of a column."""
    ys = [y for x, y in _points(bend) if 0 <= x - left_of(column) <= NODE_WIDTH]
    return not all(_is_clear(y, column, ground) for y in ys)


def _is_clear(y: float, column: int, ground: Ground) -> bool:
    boxes = (box for name, box in ground.nodes.items() if ground.columns[name] == column)
    return all(not box.y - _AROUND < y < box.bottom + _AROUND for box in boxes)


def _around(straight: _Bend, columns: Iterable[int], ground: Ground) -> Iterator[_Point]:
    """Yield where a curve enters and leaves each column, as near to the straight way as is free."""
    for column in columns:
        left = left_of(column)
        wanted = min(_points(straight), key=lambda p: abs(p[0] - left - NODE_WIDTH / 2))[1]
        heights = range(int(ground.top), int(ground.floor), _APART)
        free = [y for y in heights if _is_free(y, column, ground)]
        y = min(free or heights, key=lambda each: abs(each - wanted))
        ground.passing.add((column, y))
        yield left, y
        yield left + NODE_WIDTH, y


def _is_free(y: int, column: int, ground: Ground) -> bool:
    return (column, y) not in ground.passing and _is_clear(y, column, ground)


def _label_spots(bends: Sequence[_Bend], words: Words) -> Iterator[Box]:
    """Yield places on a curve for its label, the best first: in its middle, then beside that.

    A curve that turns back, to the same column, has its label beside it.
    """
    width, height = max(map(text_width, words)), LINE * len(words)
    beside = width / 2 if bends[0][-1][0] < bends[0][-2][0] else 0
    for offset in _OFFSETS:
        for x, y in (_point(bend, t) for bend in bends[::2] for t in _SPOTS):
            yield Box(x + beside - width / 2, y + offset * height - height / 2, width, height)


def _points(bend: _Bend) -> list[_Point]:
    return [_point(bend, number / 60) for number in range(61)]


def _point(bend: _Bend, t: float) -> _Point:
    """Return the point of a cubic Bezier curve at `t` from 0 to 1."""
    weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)
    x = sum(weight * point[0] for weight, point in zip(weights, bend, strict=True))
    y = sum(weight * point[1] for weight, point in zip(weights, bend, strict=True))
    return x, y
