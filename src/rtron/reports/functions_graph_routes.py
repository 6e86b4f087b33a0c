"""The arrows in the picture of the functions' interaction graph.

What flows to a later stage is a curve between two sides; what flows back runs in a lane above
everything; what goes through the environment runs straight between the columns.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

from rtron.functions.graph import AbstractGraph, DirectInteraction
from rtron.reports.functions_graph_ground import (
    GAP,
    LANE,
    MARGIN,
    NODE_HEIGHT,
    NODE_WIDTH,
    PAD,
    Box,
    Ground,
)
from rtron.reports.functions_graph_words import ENVIRONMENT, label_lines

LINE, LETTER, AIR = 13, 6.1, 5
_SPOTS = (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.18, 0.82)


@dataclass(frozen=True, slots=True)
class Line:
    """An arrow as an SVG path, the function that it joins to another, and what is said on it."""

    path: str
    source: str
    target: str
    lines: tuple[str, ...] = ()
    label: Box | None = None


def is_forward(edge: DirectInteraction, columns: Mapping[str, int]) -> bool:
    """Tell whether an interaction leads to the same column or to a later one."""
    return columns[edge.source] <= columns[edge.target]


def backward(edges: Iterable[DirectInteraction], columns: Mapping[str, int]) -> list[str]:
    """Return the functions with something that flows back to an earlier column."""
    return list(dict.fromkeys(e.source for e in edges if not is_forward(e, columns)))


def lanes(edges: Iterable[DirectInteraction], back: Sequence[str], ground: Ground) -> list[Line]:
    """Return the arrows that lead back; `back` has their functions from the top lane down."""
    told: set[tuple[str, str]] = set()
    heights = {name: MARGIN + LANE * (number + 0.5) for number, name in enumerate(back)}
    flowing = (edge for edge in edges if not is_forward(edge, ground.columns))
    return [_lane(edge, heights[edge.source], ground, told) for edge in flowing]


def _lane(edge: DirectInteraction, y: float, ground: Ground, told: set[tuple[str, str]]) -> Line:
    """Return an arrow that leaves to the right, runs back in its lane, and drops to the left."""
    source, target = ground.nodes[edge.source], ground.nodes[edge.target]
    number = LANE * (y / LANE % 4) / 4
    out, down = source.x + NODE_WIDTH + PAD + number / 2, target.x - PAD * 2 - number
    start, end = source.y + NODE_HEIGHT / 4, target.y + NODE_HEIGHT / 4
    path = (
        f"M{_right(source, start):.0f},{start:.0f} H{out:.0f} V{y:.0f} H{down:.0f} "
        f"V{end:.0f} H{_left(target, end):.0f}"
    )
    words = "  ".join(m.type for m in edge.messages[:2] if (edge.source, m.type) not in told)
    told.update((edge.source, m.type) for m in edge.messages[:2])
    label = Box(down + PAD, y - LINE - 2, len(words) * LETTER, LINE) if words else None
    return Line(path, edge.source, edge.target, (words,) if words else (), label)


def curves(edges: Sequence[DirectInteraction], ground: Ground) -> list[Line]:
    """Return the arrows that lead on; the longest labels choose their places first."""
    outs = _ports(edges, ground, outgoing=True)
    ins = _ports(edges, ground, outgoing=False)
    longest_last = sorted(edges, key=lambda edge: len(label_lines(edge)))
    found = {
        (edge.source, edge.target): _curve(edge, outs, ins, ground)
        for edge in reversed(longest_last)
    }
    return [found[edge.source, edge.target] for edge in edges]


_Ports = Mapping[tuple[str, str], float]


def _ports(edges: Iterable[DirectInteraction], ground: Ground, *, outgoing: bool) -> _Ports:
    """Return how high on its function's side each arrow begins or ends: none crosses its like."""
    sides: dict[str, list[DirectInteraction]] = defaultdict(list)
    for edge in edges:
        sides[edge.source if outgoing else edge.target].append(edge)
    heights = {}
    for name, its in sides.items():
        far = {e: ground.nodes[e.target if outgoing else e.source].y for e in its}
        for number, edge in enumerate(sorted(its, key=lambda e: far[e])):
            step = NODE_HEIGHT * (0.1 + 0.8 * (number + 1) / (len(its) + 1))
            heights[edge.source, edge.target] = ground.nodes[name].y + step
    return heights


def _curve(edge: DirectInteraction, outs: _Ports, ins: _Ports, ground: Ground) -> Line:
    key = (edge.source, edge.target)
    source, target = ground.nodes[edge.source], ground.nodes[edge.target]
    start = (_right(source, outs[key]), outs[key])
    if ground.columns[edge.source] == ground.columns[edge.target]:
        end = (_right(target, ins[key]), ins[key])
        pull = 46 + abs(end[1] - start[1]) / 6
        controls = ((start[0] + pull, start[1]), (end[0] + pull, end[1]))
    else:
        end = (_left(target, ins[key]), ins[key])
        pull = max((end[0] - start[0]) * 0.45, GAP * 0.45)
        controls = ((start[0] + pull, start[1]), (end[0] - pull, end[1]))
    lines = label_lines(edge)
    label = _free_spot((start, *controls, end), lines, ground)
    ground.taken.append(_around_with_air(label))
    path = "M{:.0f},{:.0f} C{:.0f},{:.0f} {:.0f},{:.0f} {:.0f},{:.0f}".format(
        *start, *controls[0], *controls[1], *end
    )
    return Line(path, edge.source, edge.target, lines, label)


def _right(box: Box, y: float) -> float:
    """Return where the right side of a function's ellipse is at a height."""
    off = (y - box.y - NODE_HEIGHT / 2) / (NODE_HEIGHT / 2)
    return box.x + NODE_WIDTH / 2 * (1 + sqrt(max(1 - off * off, 0)))


def _left(box: Box, y: float) -> float:
    return 2 * box.x + NODE_WIDTH - _right(box, y)


def _free_spot(curve: Sequence[tuple[float, float]], lines: Sequence[str], ground: Ground) -> Box:
    """Return the place on a curve where its label covers least of what stands there.

    A curve that turns back, to the same column, has its label beside it.
    """
    width, height = max(map(len, lines)) * LETTER, LINE * len(lines)
    beside = width / 2 if curve[-1][0] < curve[-2][0] else 0
    points = [_point(curve, t) for t in _SPOTS]
    spots = [_around((x + beside, y), width, height) for x, y in points]
    return min(spots, key=lambda spot: sum(map(spot.overlap, ground.taken)))


def _around(point: tuple[float, float], width: float, height: float) -> Box:
    return Box(point[0] - width / 2, point[1] - height / 2, width, height)


def _around_with_air(box: Box) -> Box:
    return Box(box.x - AIR, box.y - AIR, box.width + 2 * AIR, box.height + 2 * AIR)


def _point(curve: Sequence[tuple[float, float]], t: float) -> tuple[float, float]:
    """Return the point of a cubic Bezier curve at `t` from 0 to 1."""
    weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)
    x = sum(weight * point[0] for weight, point in zip(weights, curve, strict=True))
    y = sum(weight * point[1] for weight, point in zip(weights, curve, strict=True))
    return x, y


def through(graph: AbstractGraph, environment: Box, ground: Ground) -> list[Line]:
    """Return the dotted arrows: down from who acts, up to whom it reaches, each once."""
    acting = dict.fromkeys(edge.source for edge in graph.indirect)
    reached = dict.fromkeys(edge.target for edge in graph.indirect)
    down = [Line(_down(ground.nodes[name], environment), name, ENVIRONMENT) for name in acting]
    return down + [
        Line(_up(ground.nodes[name], environment), ENVIRONMENT, name) for name in reached
    ]


def _down(box: Box, environment: Box) -> str:
    x, y = box.x - PAD / 2, box.y + NODE_HEIGHT * 0.85
    return f"M{_left(box, y):.0f},{y:.0f} H{x:.0f} V{environment.y:.0f}"


def _up(box: Box, environment: Box) -> str:
    x, y = box.x - PAD / 2, box.y + NODE_HEIGHT * 0.85
    return f"M{x:.0f},{environment.y:.0f} V{y:.0f} H{_left(box, y):.0f}"
