"""The messages that are sent: framed once, then only stamped with the send time and a number."""

import struct
from dataclasses import dataclass

STAMP = struct.Struct("<qq")
"""Send time (`time.monotonic_ns`) and sequence number: the first 16 bytes of a body."""
PREFIX = struct.Struct("<I")
WARM_UP = (1 << 62) - 1
"""The sequence number of messages that only show that the way is open; as a double a number."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message type as a publisher declares it; `size` is the body's, bytes."""

    type: str
    md5sum: str
    definition: str
    size: int

    def frame(self) -> bytearray:
        """Return a frame of this message, its length in front and its body all zero."""
        return bytearray(PREFIX.pack(self.size) + bytes(self.size))


def stamp(frame: bytearray, sent: int, sequence: int, at: int = 0) -> None:
    """Write the send time (ns) and the sequence number into the frame that begins at `at`."""
    STAMP.pack_into(frame, at + PREFIX.size, sent, sequence)


_TWIST = """Vector3 linear
Vector3 angular
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
_IMAGE = """std_msgs/Header header
uint32 height
uint32 width
string encoding
uint8 is_bigendian
uint32 step
uint8[] data
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
"""
MESSAGES = {
    "twist": Message("geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a", _TWIST, 48),
    "image": Message("sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743", _IMAGE, 6_000_000),
}
