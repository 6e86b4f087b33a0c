"""A route on the static map: A* over its cells, and the line without needless corners."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import pairwise
from math import ceil, dist, hypot
from pathlib import Path

from .geometry import Point

Cell = tuple[int, int]


@dataclass(frozen=True)
class Grid:
    """Cells of a rectangle from the origin on, with each one's clearance (metres), row by row.

    `size` is the side of a cell, metres.
    """

    size: float
    columns: int
    clearances: Sequence[float]

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(self.clearances) // self.columns

    def clearance(self, cell: Cell) -> float:
        """Return a cell's clearance, -1 outside of the map."""
        column, row = cell
        if 0 <= column < self.columns and 0 <= row < self.rows:
            return self.clearances[row * self.columns + column]
        return -1.0

    def cell(self, point: Point) -> Cell:
        """Return the cell of a point."""
        return int(point[0] // self.size), int(point[1] // self.size)

    def center(self, cell: Cell) -> Point:
        """Return the middle of a cell."""
        return (cell[0] + 0.5) * self.size, (cell[1] + 0.5) * self.size

    def nearest(self, point: Point, margin: float) -> Cell | None:
        """Return the cell nearest to a point that has this clearance, None if no cell has it."""
        free = (cell for cell in self._cells() if self.clearance(cell) >= margin)
        return min(free, key=lambda cell: dist(self.center(cell), point), default=None)

    def has_line_of_sight(self, start: Point, end: Point, margin: float) -> bool:
        """Return whether the straight line between two points keeps this clearance."""
        steps = max(1, ceil(dist(start, end) / (self.size / 2)))
        between = (_between(start, end, step / steps) for step in range(steps + 1))
        return all(self.clearance(self.cell(point)) >= margin for point in between)

    def _cells(self) -> Iterator[Cell]:
        return ((column, row) for row in range(self.rows) for column in range(self.columns))


def load_grid(path: Path) -> Grid:
    """Return the grid in a map's file."""
    found = json.loads(path.read_text(encoding="utf-8"))
    return Grid(found["cell"], found["columns"], found["clearances"])


def _between(start: Point, end: Point, part: float) -> Point:
    return start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])


ROBOT_RADIUS = 0.105
SPACING = 0.05
"""Between the points of a route, metres."""
_MARGINS = (0.17, 0.11, 0.06, 0.02)
"""Between the robot and obstacles, metres; the widest that leaves a path counts."""
_STEPS = [(dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]
_Came = dict[Cell, Cell]


def plan(grid: Grid, start: Point, goal: Point) -> list[Point] | None:
    """Return points from start to goal, close to one another; None if there is no path.

    A start or a goal too near to something is replaced by the nearest cell that is free.
    """
    for margin in _MARGINS:
        clearance = ROBOT_RADIUS + margin
        cells = _search(grid, start, goal, clearance)
        if cells:
            last = [goal] if grid.clearance(grid.cell(goal)) >= clearance else []
            corners = [start, *map(grid.center, cells[1:-1] if last else cells[1:]), *last]
            return interpolate(_remove_redundant_corners(grid, corners, clearance))
    return None


def interpolate(corners: list[Point]) -> list[Point]:
    """Return points on the line through the corners, at most `SPACING` apart."""
    points = corners[:1]
    for (ax, ay), (bx, by) in pairwise(corners):
        parts = max(1, ceil(hypot(bx - ax, by - ay) / SPACING))
        points += [
            (ax + (bx - ax) * part / parts, ay + (by - ay) * part / parts)
            for part in range(1, parts + 1)
        ]
    return points


def _search(grid: Grid, start: Point, goal: Point, clearance: float) -> list[Cell] | None:
    """Return the cells of the shortest path between the free cells nearest to start and goal."""
    first, last = grid.nearest(start, clearance), grid.nearest(goal, clearance)
    if first is None or last is None:
        return None
    came: _Came = {first: first}
    costs = {first: 0.0}
    heap = [(dist(first, last), first)]
    done: set[Cell] = set()
    while heap:
        _, cell = heappop(heap)
        if cell == last:
            return _reconstruct_path(came, last)
        if cell not in done:
            done.add(cell)
            _visit(grid, cell, clearance, (costs, came, heap, last))
    return None


def _visit(
    grid: Grid,
    cell: Cell,
    clearance: float,
    search: tuple[dict[Cell, float], _Came, list[tuple[float, Cell]], Cell],
) -> None:
    costs, came, heap, last = search
    for dx, dy in _STEPS:
        near = cell[0] + dx, cell[1] + dy
        cost = costs[cell] + hypot(dx, dy)
        if grid.clearance(near) >= clearance and cost < costs.get(near, float("inf")):
            costs[near], came[near] = cost, cell
            heappush(heap, (cost + dist(near, last), near))


def _reconstruct_path(came: _Came, cell: Cell) -> list[Cell]:
    cells = [cell]
    while came[cells[-1]] != cells[-1]:
        cells.append(came[cells[-1]])
    return cells[::-1]


def _remove_redundant_corners(grid: Grid, corners: list[Point], clearance: float) -> list[Point]:
    """Return the corners without those that the robot can drive past in a straight line."""
    corners_left, at = corners[:1], 0
    while at < len(corners) - 1:
        later = range(len(corners) - 1, at + 1, -1)
        at = next(
            (n for n in later if grid.has_line_of_sight(corners_left[-1], corners[n], clearance)),
            at + 1,
        )
        corners_left.append(corners[at])
    return corners_left
