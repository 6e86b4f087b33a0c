"""The ROS 1 messages that the guard writes itself, as bytes with their length in front."""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rtron.guard.transport.transport import TypeInfo

_U32 = struct.Struct("<I")
_F64 = struct.Struct("<d")
_HEADER = struct.Struct("<III")

STRING = TypeInfo("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n")
FLOAT64 = TypeInfo("std_msgs/Float64", "fdb28210bfa9d7c91146260178d9a584", "float64 data\n")
_RULE = "=" * 80
DIAGNOSTICS = TypeInfo(
    "diagnostic_msgs/DiagnosticArray",
    "60810da900de1dd6ddd437c3503511da",
    "Header header\nDiagnosticStatus[] status\n"
    f"{_RULE}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
    f"{_RULE}\nMSG: diagnostic_msgs/DiagnosticStatus\n"
    "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
    "byte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values\n"
    f"{_RULE}\nMSG: diagnostic_msgs/KeyValue\nstring key\nstring value\n",
)
OK, WARN, ERROR = range(3)


@dataclass(frozen=True, slots=True)
class Status:
    """One entry of a DiagnosticArray."""

    level: int
    name: str
    message: str
    values: Mapping[str, str]


def string_message(text: str) -> bytes:
    """Return a std_msgs/String."""
    return _framed(_string(text))


def float64_message(value: float) -> bytes:
    """Return a std_msgs/Float64."""
    return _framed(_F64.pack(value))


def diagnostics_message(seq: int, stamp: int, statuses: Sequence[Status]) -> bytes:
    """Return a diagnostic_msgs/DiagnosticArray; `stamp` is wall time in ns."""
    seconds, nanoseconds = divmod(stamp, 1_000_000_000)
    head = _HEADER.pack(seq, seconds, nanoseconds) + _string("")
    return _framed(head + _U32.pack(len(statuses)) + b"".join(map(_status, statuses)))


def _status(status: Status) -> bytes:
    values = b"".join(_string(key) + _string(value) for key, value in status.values.items())
    texts = _string(status.name) + _string(status.message) + _string("rtron")
    return bytes([status.level]) + texts + _U32.pack(len(status.values)) + values


def _string(text: str) -> bytes:
    data = text.encode(errors="replace")
    return _U32.pack(len(data)) + data


def _framed(body: bytes) -> bytes:
    return _U32.pack(len(body)) + body
