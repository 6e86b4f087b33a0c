"""Where the functions stand in the picture of their interaction graph, in pixels.

Stages stand from left to right as in the paper's figure, the environment below.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from rtron.functions.graph import FunctionNode
from rtron.reports.functions_graph_words import STAGES, stage_of
from rtron.vocabulary import FunctionType

NODE_WIDTH, NODE_HEIGHT = 172, 48
GAP, SLOT, MARGIN, LANE = 200, 96, 30, 22
HEADER, PAD = 34, 14
ENVIRONMENT_HEIGHT, BELOW = 40, 40
_COLUMN = {stage: number + (number > 1) for number, stage in enumerate(STAGES)}
LAST_COLUMN = max(_COLUMN.values())


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle: its upper left corner and its size."""

    x: float
    y: float
    width: float
    height: float

    def overlap(self, other: "Box") -> float:
        """Return the area that two rectangles share."""
        width = min(self.x + self.width, other.x + other.width) - max(self.x, other.x)
        height = min(self.y + self.height, other.y + other.height) - max(self.y, other.y)
        return max(width, 0) * max(height, 0)


@dataclass(slots=True)
class Ground:
    """The functions in their places, and what the arrows leave free."""

    nodes: dict[str, Box]
    columns: dict[str, int]
    floor: float
    taken: list[Box] = field(default_factory=list)


def column_of(node: FunctionNode) -> int:
    """Return the column: Perception has two, Preprocessing before what works on its data."""
    stage = stage_of(node)
    behind = stage == "Perception" and node.function is not FunctionType.PREPROCESSING
    return _COLUMN[stage] + behind


def left_of(column: int) -> float:
    """Return the left edge of a column."""
    return MARGIN * 2 + column * (NODE_WIDTH + GAP)


def placed(functions: Sequence[FunctionNode], columns: Mapping[str, int], top: float) -> Ground:
    """Return the functions in their columns, each column spread over the height below `top`."""
    stacks: dict[int, list[str]] = defaultdict(list)
    for node in functions:
        stacks[columns[node.name]].append(node.name)
    rows = max(map(len, stacks.values()), default=1)
    boxes = {
        name: Box(left_of(column), top + _row(row, len(names), rows), NODE_WIDTH, NODE_HEIGHT)
        for column, names in stacks.items()
        for row, name in enumerate(names)
    }
    floor = top + rows * SLOT
    ground = Ground({n.name: boxes[n.name] for n in functions}, dict(columns), floor)
    ground.taken.extend(boxes.values())
    return ground


def _row(row: int, count: int, rows: int) -> float:
    """Return how far below the top a function stands: a column is spread over the whole height."""
    slot = SLOT * rows / count
    return slot * (row + 0.5) - NODE_HEIGHT / 2


def stages_of(functions: Iterable[FunctionNode], ground: Ground) -> Mapping[str, Box]:
    """Return the frame around each stage that has a function."""
    inside: dict[str, list[Box]] = defaultdict(list)
    for node in functions:
        inside[stage_of(node)].append(ground.nodes[node.name])
    top = ground.floor - SLOT * _rows(ground) - HEADER + PAD
    return {
        stage: Box(
            min(box.x for box in inside[stage]) - PAD,
            top,
            max(box.x for box in inside[stage])
            - min(box.x for box in inside[stage])
            + NODE_WIDTH
            + 2 * PAD,
            ground.floor - top,
        )
        for stage in STAGES
        if inside[stage]
    }


def _rows(ground: Ground) -> int:
    columns = list(ground.columns.values())
    return max((columns.count(column) for column in columns), default=1)


def environment_of(ground: Ground) -> Box:
    """Return the box below all stages."""
    left = min(box.x for box in ground.nodes.values())
    right = max(box.x for box in ground.nodes.values()) + NODE_WIDTH
    return Box(left, ground.floor + BELOW, right - left, ENVIRONMENT_HEIGHT)
