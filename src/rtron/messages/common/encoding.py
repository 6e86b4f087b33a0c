"""How a message is encoded: ROS 1's own serialisation, or plain CDR as ROS 2 uses it.

Either has 4 bytes in front: ROS 1 the length of the body (ROS wiki: TCPROS), CDR the encapsulation
header (OMG DDSI-RTPS 2.5, section 10.2), of which only little-endian plain CDR is read.
"""

import struct
from enum import Enum

from rtron.errors import WireError

PREFIX = 4
"""The number of bytes in front of the body."""
PADDING = 3
"""The most bytes that a CDR writer may leave after the last field: some fill up to 4."""
_OPTIONS = 3
"""Where CDR's header tells, in 2 bits, how much padding there is (OMG XTypes 1.3, 7.6.3.1.2)."""
_LENGTH = struct.Struct("<I")
_PLAIN_CDR_LE = b"\x00\x01"


class Encoding(Enum):
    """The two encodings of messages."""

    ROS1 = "ros1"
    CDR = "cdr"

    def prefix(self, length: int) -> bytes:
        """Return what stands in front of a body of `length` bytes."""
        return _LENGTH.pack(length) if self is Encoding.ROS1 else _PLAIN_CDR_LE + bytes(2)

    def check_prefix(self, message: bytes) -> None:
        """Refuse (WireError) a message whose first 4 bytes are not those of this encoding."""
        if len(message) < PREFIX:
            raise WireError(f"a message of {len(message)} bytes has not even its first {PREFIX}")
        if self is Encoding.CDR:
            if message[:2] != _PLAIN_CDR_LE:
                raise WireError(f"encapsulation {message[:2].hex()} is not little-endian plain CDR")
        elif (length := _LENGTH.unpack_from(message)[0]) != len(message) - PREFIX:
            raise WireError(f"{length} bytes are announced, {len(message) - PREFIX} are there")

    def check_end(self, at: int, message: bytes) -> None:
        """Refuse (WireError) a message whose fields do not end where its bytes do."""
        left = len(message) - at
        if left < 0:
            raise WireError(f"the message ends {-left} bytes before its fields do")
        padding, most = (message[_OPTIONS] & PADDING, PADDING) if self is Encoding.CDR else (0, 0)
        if left > most:
            raise WireError(f"{left} bytes follow the last field")
        if left < padding:
            raise WireError(f"{padding} bytes of padding are announced, {left} are there")
