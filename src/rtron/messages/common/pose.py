"""Where a message says that something is: the first pose in it, and the frame of its header."""

import math
import struct
from collections.abc import Callable
from typing import Any, NamedTuple

from rtron.errors import WireError
from rtron.messages.common.definition import HEADER, Definition, Field
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.messages.common.layout import MessageLayout, Step, count_reader, skip_field

POSE_TYPES = frozenset(
    {"geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped", "nav_msgs/Odometry"}
)
"""Types whose messages tell where the robot is, or may."""
_POSE = "geometry_msgs/Pose"
_NUMBERS = struct.Struct("<7d")
_SIZE = 8
_POSE_FIELDS = {
    "geometry_msgs/Point": ("x", "y", "z"),
    "geometry_msgs/Quaternion": ("x", "y", "z", "w"),
}


class GroundPose(NamedTuple):
    """A place on the ground of a frame (m), and a heading (rad)."""

    frame: str
    x: float
    y: float
    yaw: float


def pose_reader(definition: Definition, encoding: Encoding) -> Callable[[bytes], GroundPose] | None:
    """Return what reads the pose in messages of a type; None if it is none of `POSE_TYPES`.

    None, too, where the type is not defined as ROS defines it. What it returns raises WireError for
    a message that is too short, or whose pose is not of numbers.
    """
    if definition.type not in POSE_TYPES:
        return None
    header, *rest = definition.fields
    layout = MessageLayout(encoding)
    if header.type != HEADER or not _lay_out_header(layout, definition.nested[HEADER]):
        return None
    if not any(_lay_out_pose(layout, field, definition) for field in rest):
        return None
    return _reader(layout.steps(), encoding)


def _lay_out_header(layout: MessageLayout, header: Definition) -> bool:
    """Lay out a header, whose frame is taken; False if it has none."""
    for field in header.fields:
        if field.name == "frame_id" and field.type == "string" and not field.array:
            layout.step(_take_text(layout.encoding))
            return header.fields[-1] is field
        skip_field(layout, field, header)
    return False


def _lay_out_pose(layout: MessageLayout, field: Field, owner: Definition) -> bool:
    """Lay out a field up to the end of its pose; False if there is none in it."""
    nested = None if field.array else owner.nested.get(field.type)
    if nested is None:
        skip_field(layout, field, owner)
        return False
    if field.type != _POSE:
        return any(_lay_out_pose(layout, each, nested) for each in nested.fields)
    if not _is_standard(nested):
        return False
    for _ in range(7):
        layout.value(_SIZE, _SIZE if layout.encoding is Encoding.CDR else 1)
    return True


def _is_standard(pose: Definition) -> bool:
    """Tell whether a pose is a point and a quaternion of doubles."""
    if [each.type for each in pose.fields] != list(_POSE_FIELDS):
        return False
    return all(
        [(each.name, each.type) for each in pose.nested[type].fields]
        == [(name, "float64") for name in names]
        for type, names in _POSE_FIELDS.items()
    )


def _take_text(encoding: Encoding) -> Step:
    count_of = count_reader(encoding, 1)

    def take(data: bytes, at: int, out: list[Any]) -> int:
        count, at = count_of(data, at)
        out.append(data[at : at + count])
        return at + count

    return take


def _reader(steps: tuple[Step, ...], encoding: Encoding) -> Callable[[bytes], GroundPose]:
    def read(message: bytes) -> GroundPose:
        encoding.check_prefix(message)
        found: list[bytes] = []
        at = PREFIX
        try:
            for step in steps:
                at = step(message, at, found)
        except struct.error as error:
            raise WireError(f"the message ends before its pose does: {error}") from error
        return _pose(found[0], found[-1])

    return read


def _pose(frame: bytes, numbers: bytes) -> GroundPose:
    x, y, _, qx, qy, qz, qw = _NUMBERS.unpack(numbers)
    yaw = math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))
    if not all(map(math.isfinite, (x, y, yaw))):
        raise WireError("the pose is not of numbers")
    return GroundPose(frame.rstrip(b"\0").decode(errors="replace"), x, y, yaw)
