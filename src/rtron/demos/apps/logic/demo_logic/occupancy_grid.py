"""The static map in cells: how far each is from what the robot must not touch."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, dist
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
