"""The messages that are sent on ROS 2: CDR that is whole, with the send time and a number in it."""

import struct
from dataclasses import dataclass

DEPTH = 1000
"""How many messages each end of a measured way keeps."""
WARM_UP = (1 << 62) - 1
"""The number of messages that only show that the way is open."""
_NUMBER = struct.Struct("<q")
_HEAD = bytes.fromhex("00010000")
_IMAGE_BYTES = 6_000_000
_IMAGE = (
    struct.pack("<8xIB3x", 1, 0)
    + struct.pack("<8xIBB2xI", 1, 0, 0, _IMAGE_BYTES)
    + struct.pack("<I", _IMAGE_BYTES)
    + bytes(_IMAGE_BYTES)
)


@dataclass(frozen=True, slots=True)
class Message:
    """A type, its CDR, and where in it 8 bytes each are free for the send time and the number."""

    type: str
    cdr: bytes
    sent_at: int
    number_at: int

    def stamped(self, sent: int, number: int) -> bytes:
        """Return the message with a send time (`time.monotonic_ns`) and a number."""
        frame = bytearray(self.cdr)
        _NUMBER.pack_into(frame, self.sent_at, sent)
        _NUMBER.pack_into(frame, self.number_at, number)
        return bytes(frame)

    def read(self, frame: bytes) -> tuple[int, int]:
        """Return the send time and the number."""
        return _NUMBER.unpack_from(frame, self.sent_at)[0], _NUMBER.unpack_from(
            frame, self.number_at
        )[0]


MESSAGES = {
    "twist": Message("geometry_msgs/msg/Twist", _HEAD + bytes(48), 4, 12),
    "image": Message("sensor_msgs/msg/Image", _HEAD + _IMAGE, 4, 20),
}
