"""Transforms the positions of a message into the frame that a rule asks for."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rtron.errors import InputError
from rtron.messages.common.definition import HEADER, Definition, Field
from rtron.messages.expressions.geometry import PlanarTransform, planar_transform
from rtron.messages.expressions.protobuf_types import is_usable_name
from rtron.vocabulary import Transform

POINTS = ("geometry_msgs/Point", "geometry_msgs/Point32")
"""The types whose values are positions; a Vector3 is none."""


class FrameError(Exception):
    """The positions of a message cannot be compared in the frame asked for."""


@dataclass(frozen=True, slots=True)
class _MessagePart:
    """The names of a message's header, of its positions, and of nested messages with positions."""

    header: str
    points: tuple[Field, ...]
    inner: tuple[tuple[Field, "_MessagePart"], ...]


class ReferenceFrame:
    """The frame that a rule asks for; `transform` transforms a message's positions into it.

    A position is in the frame of the nearest header around it that names one: a pose in a goal in
    the pose's own, not in the goal's. Where a transform is needed it changes x and y of every
    Point and Point32; directions and other numbers stay as they are.
    """

    __slots__ = ("_name", "_part", "_points", "_transforms")

    def __init__(
        self,
        name: str,
        definition: Definition,
        fields: Collection[str],
        transforms: Sequence[Transform] = (),
    ) -> None:
        self._name = name
        self._transforms = _transforms_into(name, transforms)
        self._part = _message_part(definition, {}, lambda field: field.name in fields)
        self._points = _has_points(self._part)
        _check_headers(self._part, definition, name)

    def transform(self, message: Any) -> None:  # noqa: ANN401 - a protobuf message of any type
        """Transform the positions of a message into the frame; raise FrameError if that fails."""
        if self._points:
            self._transform(message, self._part, "")
            return
        actual = _frame_of(message, self._part, "")
        if actual != self._name:
            why = "it has no points to transform"
            raise FrameError(_mismatch_message(actual, self._name, why))

    def _transform(self, message: Any, part: _MessagePart, frame: str) -> None:  # noqa: ANN401
        frame = _frame_of(message, part, frame)
        if part.points and frame != self._name:
            self._transform_points(message, part.points, frame)
        for field, inner in part.inner:
            value = getattr(message, field.name)
            for each in value if field.array else (value,):
                self._transform(each, inner, frame)

    def _transform_points(self, message: Any, points: Sequence[Field], frame: str) -> None:  # noqa: ANN401
        for field in points:
            value = getattr(message, field.name)
            for point in value if field.array else (value,):
                moved = self._transforms.get(frame)
                if moved is None:
                    why = "no transform is configured"
                    raise FrameError(_mismatch_message(frame, self._name, why))
                point.x, point.y = moved.apply(point.x, point.y)


def without_slash(frame: str) -> str:
    """Return a frame as tf2 spells it."""
    return frame.lstrip("/")


def _mismatch_message(actual: str, requested: str, why: str) -> str:
    if not actual:
        return f"positions are in no frame, the rule asks for {requested}"
    return f"positions are in frame {actual[:80]}, the rule asks for {requested}, and {why}"


def _frame_of(message: Any, part: _MessagePart, outer: str) -> str:  # noqa: ANN401
    if not part.header:
        return outer
    return without_slash(getattr(message, part.header).frame_id) or outer


def _transforms_into(name: str, transforms: Sequence[Transform]) -> Mapping[str, PlanarTransform]:
    found: dict[str, PlanarTransform] = {}
    for each in transforms:
        if without_slash(each.target) == name:
            found[without_slash(each.source)] = planar_transform(each)
    for each in transforms:
        if without_slash(each.source) == name:
            found.setdefault(without_slash(each.target), planar_transform(each).inverse())
    return found


def _message_part(
    definition: Definition, known: dict[str, _MessagePart], is_selected: Callable[[Field], bool]
) -> _MessagePart:
    """Return what is to be visited in a message; each nested type once, in `known`."""
    inner: list[tuple[Field, _MessagePart]] = []
    points: list[Field] = []
    for field in definition.fields:
        nested = definition.nested.get(field.type)
        if nested is None or not is_usable_name(field.name) or not is_selected(field):
            continue
        if is_point(nested):
            points.append(field)
            continue
        if field.type not in known:
            known[field.type] = _message_part(nested, known, lambda _: True)
        if _has_points(known[field.type]):
            inner.append((field, known[field.type]))
    return _MessagePart(header_of(definition), tuple(points), tuple(inner))


def is_point(definition: Definition) -> bool:
    """Tell whether a type is a position: one of `POINTS`, with x and y."""
    return definition.type in POINTS and all(
        (field := definition.find(name)) and field.type.startswith("float") and not field.array
        for name in "xy"
    )


def header_of(definition: Definition) -> str:
    """Return the name of the header with a frame, empty if there is none."""
    for field in definition.fields:
        if field.type == HEADER and not field.array and is_usable_name(field.name):
            frame = definition.nested[HEADER].find("frame_id")
            return field.name if frame and frame.type == "string" and not frame.array else ""
    return ""


def _has_points(part: _MessagePart) -> bool:
    return bool(part.points or part.inner)


def _check_headers(part: _MessagePart, definition: Definition, frame: str) -> None:
    if part.header or (
        not part.points and part.inner and all(_has_headers(p) for _, p in part.inner)
    ):
        return
    raise InputError(
        f"{definition.type} has no header that tells the frame of its positions",
        help=f"the frame {frame} cannot be asked for; compare without frame and areas",
    )


def _has_headers(part: _MessagePart) -> bool:
    """Tell whether all the positions in a part have a header around them."""
    return bool(part.header) or (not part.points and all(_has_headers(p) for _, p in part.inner))
