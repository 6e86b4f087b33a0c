"""Whether every float of a message is a number: in trajectories, arrays and wrenches too."""

import math
import struct
from collections.abc import Callable
from typing import Any

from rtron.errors import WireError
from rtron.messages.common.definition import SIZES, Definition, Field
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.layout import (
    MessageLayout,
    Step,
    align_to,
    alignment,
    count_reader,
    each_element,
    lay_out_empty_message,
    message_reader,
    skip_field,
)

NUMERIC_COMMAND_TYPES = frozenset(
    {
        "geometry_msgs/Wrench",
        "geometry_msgs/WrenchStamped",
        "std_msgs/Float32MultiArray",
        "std_msgs/Float64MultiArray",
        "trajectory_msgs/JointTrajectory",
        "trajectory_msgs/MultiDOFJointTrajectory",
    }
)
"""Types of commands, in ROS 1 spelling, in which NaN and Inf have no meaning of their own."""

_CODES = {"float32": "f", "float64": "d"}


def finite_checker(definition: Definition, encoding: Encoding) -> Callable[[bytes], object]:
    """Return what refuses (WireError) a message with a float that is NaN or Inf."""
    layout = MessageLayout(encoding)
    _fields(layout, definition)
    return message_reader(layout.steps(), encoding)


def _fields(layout: MessageLayout, definition: Definition) -> None:
    lay_out_empty_message(layout, definition)
    for field in definition.fields:
        _field(layout, field, definition)


def _field(layout: MessageLayout, field: Field, definition: Definition) -> None:
    nested = definition.nested.get(field.type)
    if field.type in _CODES:
        layout.step(_check_floats(field, layout.encoding))
    elif nested and field.array:
        layout.step(each_element(layout, field, definition, _field))
    elif nested:
        _fields(layout, nested)
    else:
        skip_field(layout, field, definition)


def _check_floats(field: Field, encoding: Encoding) -> Step:
    """Return the step over one float or an array of them."""
    code, size = _CODES[field.type], SIZES[field.type]
    align = alignment(field.type, encoding)
    count_of = count_reader(encoding, size)
    fixed = field.length if field.array else 1

    def check(data: bytes, at: int, out: list[Any]) -> int:  # noqa: ARG001
        count, at = (fixed, at) if fixed is not None else count_of(data, at)
        if not count:
            return at
        at = align_to(align, at)
        if not all(map(math.isfinite, struct.unpack_from(f"<{count}{code}", data, at))):
            raise WireError(f"NaN or Inf in {field.name}")
        return at + count * size

    return check
