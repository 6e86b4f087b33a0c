"""The functions that expressions have besides CEL's own: places, areas and distances."""

from collections.abc import Callable, Sequence
from typing import Any

from rtron.messages.geometry import XY, Polygon, distance
from rtron.messages.protobuf_types import AREA, POINT, protobuf_name

FUNCTIONS = ("inside", "distance", "place")


def functions(
    cel: Any,  # noqa: ANN401 - CEL has no types
    *,
    points: Sequence[str],
    areas: Sequence[Polygon],
    classes: tuple[Any, Any],
) -> list[Any]:
    """Declare the functions for positions of the types `points`.

    An area value has its index in `areas`; `classes` are protobuf's for a point and an area. What
    is called raises ValueError for a position that is not finite: the expression is not known.
    """
    make_point, area_class = classes
    real, truth, area = cel.Type.DOUBLE, cel.Type.BOOL, cel.Type(protobuf_name(AREA))
    types = [cel.Type(protobuf_name(each)) for each in points]

    def inside(point: Any, area: Any) -> bool:  # noqa: ANN401 - protobuf messages
        return areas[int(area.index)].contains(_xy(point))

    def distance_of(one: Any, other: Any) -> float:  # noqa: ANN401
        if isinstance(other, area_class):
            return areas[int(other.index)].distance(_xy(one))
        return distance(_xy(one), _xy(other))

    def place(x: float, y: float) -> Any:  # noqa: ANN401
        return make_point(x=x, y=y)

    to_area = [[each, area] for each in types]
    between = [[one, other] for one in types for other in types]
    return [
        _function(cel, "inside", truth, to_area, inside),
        _function(cel, "distance", real, to_area + between, distance_of),
        _function(cel, "place", cel.Type(protobuf_name(POINT)), [[real, real]], place),
    ]


def _function(
    cel: Any,  # noqa: ANN401 - CEL has no types
    name: str,
    result: Any,  # noqa: ANN401
    signatures: Sequence[Sequence[Any]],
    called: Callable[..., Any],
) -> Any:  # noqa: ANN401
    """Declare a function; at run time CEL cannot tell messages apart, so one is called for all."""
    overloads = [
        cel.Overload(
            "_".join((name, *(each.name() for each in parameters))),
            return_type=result,
            parameters=parameters,
            **({} if index else {"impl": called}),
        )
        for index, parameters in enumerate(signatures)
    ]
    return cel.FunctionDecl(name, overloads)


def _xy(point: Any) -> XY:  # noqa: ANN401 - a protobuf message
    return float(point.x), float(point.y)
