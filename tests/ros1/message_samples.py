"""Messages made and written by rosbags, which is what ours is compared with."""

import random
import struct

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from rtron.messages import Encoding
from rtron.vocabulary import Area, Point

ROS1 = get_typestore(Stores.ROS1_NOETIC)
ROS2 = get_typestore(Stores.ROS2_JAZZY)
ENCODINGS = (Encoding.ROS1, Encoding.CDR)
DOUBLES = [0.0, -0.0, 1.0, -1.0, 5e-324, -2.2e-308, 1.8e308, float("inf"), float("-inf")]
INTEGERS = {
    f"{sign}int{bits}": (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
} | {"byte": (0, 127), "char": (0, 255), "uint64": (0, 2**63 - 1)}


def store(encoding):
    return ROS1 if encoding is Encoding.ROS1 else ROS2


def long_name(type):
    package, _, name = type.partition("/")
    return f"{package}/msg/{name}"


def make(encoding, type, *values, **fields):
    """Return a message of rosbags' class for `type`."""
    return store(encoding).types[long_name(type)](*values, **fields)


def encode(encoding, type, message):
    """Return a message as it travels."""
    if encoding is Encoding.CDR:
        return bytes(ROS2.serialize_cdr(message, long_name(type)))
    body = bytes(ROS1.serialize_ros1(message, long_name(type)))
    return struct.pack("<I", len(body)) + body


def header(encoding, frame="map", seconds=3, nanoseconds=500_000_000):
    stamp = make(encoding, "builtin_interfaces/Time", seconds, nanoseconds)
    if encoding is Encoding.ROS1:
        return make(encoding, "std_msgs/Header", 7, stamp, frame)
    return make(encoding, "std_msgs/Header", stamp, frame)


def point(encoding, x=1.0, y=2.0, z=3.0):
    return make(encoding, "geometry_msgs/Point", x, y, z)


def pose(encoding, x=1.0, y=2.0):
    turn = make(encoding, "geometry_msgs/Quaternion", 0.0, 0.0, 0.0, 1.0)
    return make(encoding, "geometry_msgs/Pose", point(encoding, x, y), turn)


def pose_stamped(encoding, frame="map", x=1.0, y=2.0):
    """Return the bytes of a PoseStamped."""
    made = make(encoding, POSE, header(encoding, frame), pose(encoding, x, y))
    return encode(encoding, POSE, made)


POSE = "geometry_msgs/PoseStamped"


def square(name="zone", frame="map", side=4.0):
    corners = ((0.0, 0.0), (side, 0.0), (side, side), (0.0, side))
    return Area(name=name, frame=frame, polygon=tuple(Point(x=x, y=y) for x, y in corners))


class Generator:
    """Makes messages of any type of a store, from a seed, with values dense at the bounds."""

    strings = ("", "a", "map", "ä€😀", "x" * 200, "a\0b")

    def __init__(self, encoding, seed):
        self._store = store(encoding)
        self._random = random.Random(seed)

    def message(self, type):
        """Return a message and what its fields are worth in an expression."""
        made, worth = {}, {}
        for name, desc in self._store.fielddefs[type][1]:
            made[name], worth[name] = self._field(desc)
        return self._store.types[type](**made), worth

    def _field(self, desc):
        kind, detail = desc
        if kind == Nodetype.BASE:
            return self._base(detail[0])
        if kind == Nodetype.NAME:
            return self._named(detail)
        inner, length = detail
        count = length
        if kind == Nodetype.SEQUENCE:
            count = min(self._random.choice([0, 1, 2, 5]), length or 5)
        pairs = [self._field(inner) for _ in range(count)]
        values, worth = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
        if inner[0] == Nodetype.BASE and inner[1][0] != "string":
            return self._array(inner[1][0], values, worth)
        return values, worth

    def _array(self, base, values, worth):
        dtype = {"byte": "uint8", "char": "uint8"}.get(base, base)
        return np.array(values, dtype=dtype), bytes(worth) if base in ("uint8", "char") else worth

    def _named(self, type):
        if type not in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"):
            return self.message(type)
        seconds = self._random.choice([0, 1, 2**31 - 1])
        nanoseconds = self._random.choice([0, 1, 999_999_999])
        return self._store.types[type](seconds, nanoseconds), seconds + nanoseconds * 1e-9

    def _base(self, base):
        pick = self._random.choice
        if base == "bool":
            return (value := pick([False, True])), value
        if base == "string":
            return (value := pick(self.strings)), value
        if base.startswith("float"):
            value = pick(DOUBLES) if base == "float64" else pick([0.0, -0.0, 1.5, float("inf")])
            return value, value
        low, high = INTEGERS[base]
        return (value := pick([low, low + 1, 1, high - 1, high])), value
