"""The environment in the picture of the functions' interaction graph.

Each thing that changes has a lane of its own in it: down to it from who acts, up from it to whom
the change reaches.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rtron.functions.graph import AbstractGraph, IndirectInteraction
from rtron.reports.functions.ground import NODE_HEIGHT, PAD, Box, Ground, left_of
from rtron.reports.functions.routes import Line, left_side

BELOW, ROW, FOOT = 30, 30, 30
_FIRST, _STEP = 8, 9
_Key = tuple[int, str, bool]


@dataclass(frozen=True, slots=True)
class EnvironmentLane:
    """What changes, as a level line from `left` to `right`, named right of it."""

    line: Line
    y: float
    right: float


def environment_of(graph: AbstractGraph, ground: Ground) -> Box | None:
    """Return the box below all stages, with a row for each thing that changes; None if none."""
    changes = _changes(graph)
    if not changes:
        return None
    left = min(box.x for box in ground.nodes.values()) - PAD
    right = max(box.right for box in ground.nodes.values()) + PAD
    return Box(left, ground.floor + BELOW, right - left, ROW * len(changes) + FOOT)


def environment_lanes(
    graph: AbstractGraph, environment: Box, ground: Ground
) -> tuple[list[EnvironmentLane], list[Line]]:
    """Return the lanes of the environment, and the arrows to them and from them.

    What runs beside a column leaves no place to labels.
    """
    tracks = _tracks(graph, ground)
    lanes: list[EnvironmentLane] = []
    arrows: list[Line] = []
    for row, edges in enumerate(_changes(graph).values()):
        y = environment.y + ROW * (row + 0.7)
        lanes.append(_lane(edges, y, tracks))
        arrows.extend(_arrows(edges, y, tracks, ground))
    for (column, _, _), x in tracks.items():
        top = min(b.y for name, b in ground.nodes.items() if ground.columns[name] == column)
        ground.lines.append(Box(x - 1, top, 2, ground.floor - top))
    return lanes, arrows


def _changes(graph: AbstractGraph) -> Mapping[str, list[IndirectInteraction]]:
    found: dict[str, list[IndirectInteraction]] = defaultdict(list)
    for edge in graph.indirect:
        found[edge.through].append(edge)
    return found


def _tracks(graph: AbstractGraph, ground: Ground) -> Mapping[_Key, float]:
    """Return where each change runs beside a column, down (True) or up: none shares its track."""
    used: dict[int, list[_Key]] = defaultdict(list)
    for edge in graph.indirect:
        for name, down in ((edge.source, True), (edge.target, False)):
            key = (ground.columns[name], edge.through, down)
            if key not in used[key[0]]:
                used[key[0]].append(key)
    return {
        key: left_of(key[0]) - _FIRST - _STEP * number
        for keys in used.values()
        for number, key in enumerate(keys)
    }


def _lane(
    edges: Sequence[IndirectInteraction], y: float, tracks: Mapping[_Key, float]
) -> EnvironmentLane:
    its = [x for (_, through, _), x in tracks.items() if through == edges[0].through]
    line = _line(edges, f"M{min(its):.0f},{y:.0f} H{max(its):.0f}", head=False)
    return EnvironmentLane(line=line, y=y, right=max(tracks.values()))


def _arrows(
    edges: Sequence[IndirectInteraction], y: float, tracks: Mapping[_Key, float], ground: Ground
) -> Iterator[Line]:
    """Yield what runs between a lane and the functions: a trunk beside each column, its branches.

    `y` is the lane's height.
    """
    for (column, through, down), x in tracks.items():
        own: dict[str, list[IndirectInteraction]] = defaultdict(list)
        for edge in edges:
            name = edge.source if down else edge.target
            if (ground.columns[name], edge.through) == (column, through):
                own[name].append(edge)
        for name, its in own.items():
            side, height = _port(ground.nodes[name], x)
            ends = (side, x) if down else (x, side)
            path = "M{:.0f},{h:.0f} H{:.0f}".format(*ends, h=height)
            yield _line(its, path, head=not down)
        if own:
            top = min(_port(ground.nodes[name], x)[1] for name in own)
            ends = (top, y) if down else (y, top)
            path = "M{x:.0f},{:.0f} V{:.0f}".format(*ends, x=x)
            yield _line([e for its in own.values() for e in its], path, head=down)


def _port(box: Box, x: float) -> tuple[float, float]:
    """Return the side and the height at which an arrow from a track at `x` joins a function."""
    number = (box.x - _FIRST - x) / _STEP
    height = box.y + NODE_HEIGHT * (0.88 - 0.11 * (number % 3))
    return left_side(box, height), height


def _line(edges: Sequence[IndirectInteraction], path: str, *, head: bool) -> Line:
    return Line(
        path,
        tuple(dict.fromkeys(edge.source for edge in edges)),
        tuple(dict.fromkeys(edge.target for edge in edges)),
        through=edges[0].through,
        head=head,
    )
