"""The picture of the functions' interaction graph: where all of it stands, in pixels."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rtron.functions.graph import AbstractGraph
from rtron.reports.functions_graph_ground import (
    BELOW,
    ENVIRONMENT_HEIGHT,
    HEADER,
    LANE,
    LAST_COLUMN,
    MARGIN,
    NODE_WIDTH,
    Box,
    column_of,
    environment_of,
    left_of,
    placed,
    stages_of,
)
from rtron.reports.functions_graph_routes import (
    Line,
    backward,
    curves,
    is_forward,
    lanes,
    through,
)


@dataclass(frozen=True, slots=True)
class Layout:
    """The whole picture: functions and stages by name, the environment, and the arrows."""

    width: float
    height: float
    nodes: Mapping[str, Box]
    stages: Mapping[str, Box]
    environment: Box | None
    direct: Sequence[Line]
    indirect: Sequence[Line]


def lay_out(graph: AbstractGraph) -> Layout:
    """Return the picture of a graph; the same graph gives the same picture."""
    columns = {node.name: column_of(node) for node in graph.functions}
    back = backward(graph.direct, columns)
    top = MARGIN + LANE * len(back) + HEADER
    ground = placed(graph.functions, columns, top)
    forward = [edge for edge in graph.direct if is_forward(edge, columns)]
    direct = [*lanes(graph.direct, back, ground), *curves(forward, ground)]
    environment = environment_of(ground) if graph.indirect else None
    indirect = through(graph, environment, ground) if environment else []
    height = ground.floor + (BELOW + ENVIRONMENT_HEIGHT if environment else 0) + MARGIN
    return Layout(
        width=left_of(LAST_COLUMN) + NODE_WIDTH + MARGIN * 2,
        height=height,
        nodes=ground.nodes,
        stages=stages_of(graph.functions, ground),
        environment=environment,
        direct=direct,
        indirect=indirect,
    )
