"""Where the functions stand in the picture of their interaction graph, in pixels.

Stages stand from left to right as in the paper's figure, the environment below. A column that no
function stands in takes no room.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf

from rtron.functions.graph import FunctionNode
from rtron.reports.functions.labels import STAGES, stage_of
from rtron.vocabulary import FunctionType

NODE_WIDTH, NODE_HEIGHT = 204, 54
GAP, MARGIN, LANE = 230, 30, 26
HEADER, PAD, AIR = 40, 36, 4
_TITLE_LETTER = 11
_COLUMN = {stage: number + (number > 1) for number, stage in enumerate(STAGES)}


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle: its upper left corner and its size."""

    x: float
    y: float
    width: float
    height: float

    @property
    def right(self) -> float:
        """Where it ends on the right."""
        return self.x + self.width

    @property
    def bottom(self) -> float:
        """Where it ends below."""
        return self.y + self.height

    def overlap(self, other: "Box") -> float:
        """Return the area that two rectangles share."""
        width = min(self.right, other.right) - max(self.x, other.x)
        height = min(self.bottom, other.bottom) - max(self.y, other.y)
        return max(width, 0) * max(height, 0)

    def wider(self, by: float) -> "Box":
        """Return the rectangle with so much more on each side."""
        return Box(self.x - by, self.y - by, self.width + 2 * by, self.height + 2 * by)


@dataclass(slots=True)
class Ground:
    """The functions in their places, what labels have taken, and the level and upright lines.

    `clash` is the area that labels share with what was written there before; `passing` are the
    columns and heights at which arrows pass between functions.
    """

    nodes: dict[str, Box]
    columns: Mapping[str, int]
    top: float
    floor: float
    taken: list[Box] = field(default_factory=list)
    lines: list[Box] = field(default_factory=list)
    clash: float = 0
    passing: set[tuple[int, int]] = field(default_factory=set)

    def place(self, spots: Iterable[Box]) -> Box:
        """Take the first of some rectangles that is free, else the one that covers least.

        To cover lines is not as bad as to cover what is written.
        """
        best, least = Box(0, 0, 0, 0), (inf, inf)
        for spot in spots:
            covered = sum(map(spot.overlap, self.taken)), sum(map(spot.overlap, self.lines))
            if covered < least:
                best, least = spot, covered
            if not any(covered):
                break
        self.clash += least[0]
        self.taken.append(best.wider(AIR))
        return best


def columns_of(functions: Iterable[FunctionNode]) -> dict[str, int]:
    """Return each function's column: Perception has two, Preprocessing before what works on it."""
    wanted = {node.name: _column(node) for node in functions}
    used = sorted(set(wanted.values()))
    return {name: used.index(column) for name, column in wanted.items()}


def _column(node: FunctionNode) -> int:
    stage = stage_of(node)
    behind = stage == "Perception" and node.function is not FunctionType.PREPROCESSING
    return _COLUMN[stage] + behind


def left_of(column: int) -> float:
    """Return the left edge of a column's functions."""
    return MARGIN * 2 + PAD + column * (NODE_WIDTH + GAP)


def placed(columns: Mapping[str, int], top: float, slot: float) -> Ground:
    """Return the functions in their columns, each column spread over the height below `top`.

    The fullest column has one function in each `slot` pixels.
    """
    stacks: dict[int, list[str]] = defaultdict(list)
    for name, column in columns.items():
        stacks[column].append(name)
    height = slot * max(map(len, stacks.values()), default=1)
    boxes = {
        name: Box(left_of(column), top + y, NODE_WIDTH, NODE_HEIGHT)
        for column, names in stacks.items()
        for name, y in zip(names, _spread(len(names), height), strict=True)
    }
    ordered = {name: boxes[name] for name in columns}
    return Ground(ordered, columns, top, top + height, taken=list(boxes.values()))


def _spread(count: int, height: float) -> Sequence[float]:
    """Return how far below the top each of a column's functions stands."""
    slot = height / count
    return [slot * (row + 0.5) - NODE_HEIGHT / 2 for row in range(count)]


def stages_of(functions: Iterable[FunctionNode], ground: Ground) -> Mapping[str, Box]:
    """Return the frame around each stage that has a function; its title's place is taken."""
    inside: dict[str, list[Box]] = defaultdict(list)
    for node in functions:
        inside[stage_of(node)].append(ground.nodes[node.name])
    frames = {stage: _frame(inside[stage], ground) for stage in STAGES if inside[stage]}
    for stage, frame in frames.items():
        width = len(stage) * _TITLE_LETTER
        ground.taken.append(Box(frame.x + (frame.width - width) / 2, frame.y, width, HEADER - AIR))
    return frames


def _frame(boxes: Sequence[Box], ground: Ground) -> Box:
    left, right = min(box.x for box in boxes) - PAD, max(box.right for box in boxes) + PAD
    top = ground.top - HEADER
    return Box(left, top, right - left, ground.floor - top)
