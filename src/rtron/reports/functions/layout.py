"""The picture of the functions' interaction graph: where all of it stands, in pixels."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rtron.functions.graph import AbstractGraph
from rtron.reports.functions.curves import curves
from rtron.reports.functions.environment import (
    EnvironmentLane,
    environment_lanes,
    environment_of,
)
from rtron.reports.functions.ground import (
    HEADER,
    LANE,
    MARGIN,
    PAD,
    Box,
    columns_of,
    placed,
    stages_of,
)
from rtron.reports.functions.routes import Line, backward, is_forward, lanes

LEGEND_WIDTH, LEGEND_ROW = 700, 24
_SLOTS = (112, 128, 148, 172, 200)


@dataclass(frozen=True, slots=True)
class Layout:
    """The whole picture: functions and stages by name, the environment, arrows and legend.

    `clash` is the area that labels share with what else stands there.
    """

    width: float
    height: float
    nodes: Mapping[str, Box]
    stages: Mapping[str, Box]
    environment: Box | None
    lanes: Sequence[EnvironmentLane]
    direct: Sequence[Line]
    indirect: Sequence[Line]
    legend: Box
    clash: float


def lay_out(graph: AbstractGraph, legend_rows: int) -> Layout:
    """Return the picture of a graph; the same graph gives the same picture.

    It is as high as its labels need to stand apart from one another.
    """
    best = _laid_out(graph, legend_rows, _SLOTS[0])
    for slot in _SLOTS[1:]:
        if not best.clash:
            break
        best = min(best, _laid_out(graph, legend_rows, slot), key=lambda each: each.clash)
    return best


def _laid_out(graph: AbstractGraph, legend_rows: int, slot: float) -> Layout:
    columns = columns_of(graph.functions)
    back = backward(graph.direct, columns)
    ground = placed(columns, MARGIN + LANE * len(back) + HEADER, slot)
    stages = stages_of(graph.functions, ground)
    environment = environment_of(graph, ground)
    through = environment_lanes(graph, environment, ground) if environment else ([], [])
    forward = [edge for edge in graph.direct if is_forward(edge, columns)]
    direct = [*lanes(graph.direct, back, ground), *curves(forward, ground)]
    bottom = environment.bottom if environment else ground.floor
    right = max((box.right for box in (*ground.taken, *ground.lines)), default=0) + PAD
    legend = Box(MARGIN * 2, bottom + MARGIN, LEGEND_WIDTH, LEGEND_ROW * legend_rows)
    return Layout(
        width=max(right, legend.right) + MARGIN,
        height=legend.bottom + MARGIN / 2,
        nodes=ground.nodes,
        stages=stages,
        environment=environment,
        lanes=through[0],
        direct=direct,
        indirect=through[1],
        legend=legend,
        clash=ground.clash,
    )
