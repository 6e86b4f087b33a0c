"""The static map in cells: how far each is from what the robot must not touch."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, dist
from pathlib import Path

from .geometry import Point
from .static_map import StaticMap, read_map

CELL = 0.1
"""Side of a cell, metres."""
_MOST_CELLS = 250_000
Cell = tuple[int, int]


@dataclass(frozen=True)
class Grid:
    """Cells of a rectangle, with each one's clearance (metres), row by row."""

    low: Point
    columns: int
    rows: int
    clearances: tuple[float, ...]

    def clearance(self, cell: Cell) -> float:
        """Return a cell's clearance, -1 outside of the map."""
        column, row = cell
        if 0 <= column < self.columns and 0 <= row < self.rows:
            return self.clearances[row * self.columns + column]
        return -1.0

    def cell(self, point: Point) -> Cell:
        """Return the cell of a point."""
        return int((point[0] - self.low[0]) // CELL), int((point[1] - self.low[1]) // CELL)

    def center(self, cell: Cell) -> Point:
        """Return the middle of a cell."""
        return self.low[0] + (cell[0] + 0.5) * CELL, self.low[1] + (cell[1] + 0.5) * CELL

    def nearest(self, point: Point, margin: float) -> Cell | None:
        """Return the cell nearest to a point that has this clearance, None if no cell has it."""
        free = (cell for cell in self._cells() if self.clearance(cell) >= margin)
        return min(free, key=lambda cell: dist(self.center(cell), point), default=None)

    def has_line_of_sight(self, start: Point, end: Point, margin: float) -> bool:
        """Return whether the straight line between two points keeps this clearance."""
        steps = max(1, ceil(dist(start, end) / (CELL / 2)))
        between = (_between(start, end, step / steps) for step in range(steps + 1))
        return all(self.clearance(self.cell(point)) >= margin for point in between)

    def _cells(self) -> Iterator[Cell]:
        return ((column, row) for row in range(self.rows) for column in range(self.columns))


def grid_of(static: StaticMap) -> Grid:
    """Return the grid of a map; ValueError if it would have too many cells."""
    columns, rows = (
        ceil((high - low) / CELL) for low, high in zip(static.low, static.high, strict=True)
    )
    if columns * rows > _MOST_CELLS:
        raise ValueError(f"a map of {columns} x {rows} cells is too large")
    empty = Grid(static.low, columns, rows, ())
    return Grid(
        static.low,
        columns,
        rows,
        tuple(static.clearance(empty.center(cell)) for cell in empty._cells()),  # noqa: SLF001
    )


def load_grid(path: Path) -> Grid:
    """Return the grid of a scene's file; made anew only when the file says something new."""
    return _grid(path.read_text(encoding="utf-8"))


@lru_cache(maxsize=1)
def _grid(text: str) -> Grid:
    return grid_of(read_map(text))


def _between(start: Point, end: Point, part: float) -> Point:
    return start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])
