"""Messages about velocities, as the guard sees them: with their length in front."""

import struct

from rtron.guard.transport.common.protocol import TypeInfo

FLOAT64 = TypeInfo("std_msgs/Float64", "fdb28210bfa9d7c91146260178d9a584")
IMAGE = TypeInfo("sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743")


def twist(x=0.0, y=0.0, z=0.0, turn=0.0):
    return struct.pack("<I6d", 48, x, y, z, 0.0, 0.0, turn)


def speeds(messages):
    """Return (linear.x, angular.z) of each Twist."""
    values = (struct.unpack("<I6d", message) for message in messages)
    return [(each[1], each[6]) for each in values]


def float64(value):
    return struct.pack("<Id", 8, value)


def floats(messages):
    return [struct.unpack("<Id", message)[1] for message in messages]


def image(stamp, size=0):
    """Return a sensor_msgs/Image of one row, with `stamp` in ns."""
    seconds, nanoseconds = divmod(stamp, 10**9)
    head = struct.pack("<IIII3s", 0, seconds, nanoseconds, 3, b"cam")
    body = head + struct.pack("<III4sBII", 1, size, 4, b"rgb8", 0, size, size) + bytes(size)
    return struct.pack("<I", len(body)) + body
