"""A* over the grid, and the line that is left when its needless corners are cut."""

from heapq import heappop, heappush
from itertools import pairwise
from math import ceil, dist, hypot

from .geometry import Point
from .occupancy_grid import Cell, Grid

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
