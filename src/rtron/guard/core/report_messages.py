"""The guard's own messages, as bytes in the encoding of either ROS."""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rtron.errors import WireError
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.encoding import PREFIX, Encoding

_F64 = struct.Struct("<d")
_LENGTH = struct.Struct("<I")
_ALIGNMENT = 4

STRING = TypeInfo("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n")
UINT64 = TypeInfo("std_msgs/UInt64", "1b2a79973e8bf53d7b53acb71299cb57", "uint64 data\n")
FLOAT64 = TypeInfo("std_msgs/Float64", "fdb28210bfa9d7c91146260178d9a584", "float64 data\n")
_SEPARATOR = "=" * 80


def _diagnostics_type(md5sum: str, header: str) -> TypeInfo:
    return TypeInfo(
        "diagnostic_msgs/DiagnosticArray",
        md5sum,
        "Header header\nDiagnosticStatus[] status\n"
        f"{_SEPARATOR}\nMSG: std_msgs/Header\n{header}string frame_id\n"
        f"{_SEPARATOR}\nMSG: diagnostic_msgs/DiagnosticStatus\n"
        "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
        "byte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values\n"
        f"{_SEPARATOR}\nMSG: diagnostic_msgs/KeyValue\nstring key\nstring value\n",
    )


DIAGNOSTICS = {
    Encoding.ROS1: _diagnostics_type(
        "60810da900de1dd6ddd437c3503511da", "uint32 seq\ntime stamp\n"
    ),
    Encoding.CDR: _diagnostics_type(
        "5174d6fb6863edc1c01a605da45a367f", "builtin_interfaces/Time stamp\n"
    ),
}
"""The type of the guard's diagnostics; headers of ROS 2 have no sequence number."""
OK, WARN, ERROR = range(3)


@dataclass(frozen=True, slots=True)
class Status:
    """One entry of a DiagnosticArray."""

    level: int
    name: str
    message: str
    values: Mapping[str, str]


class MessageWriter:
    """Writes one message, field by field; alignment is counted from the body's first byte."""

    def __init__(self, encoding: Encoding) -> None:
        self._encoding = encoding
        self._body = bytearray()

    def byte(self, value: int) -> None:
        """Write a byte."""
        self._body.append(value)

    def uint32(self, value: int) -> None:
        """Write 4 bytes, least first."""
        if self._encoding is Encoding.CDR:
            self._body += bytes(-len(self._body) % _ALIGNMENT)
        self._body += value.to_bytes(4, "little")

    def string(self, text: str) -> None:
        """Write a text as UTF-8; in CDR a zero byte ends it, so its own become `?`."""
        data = text.encode(errors="replace")
        if self._encoding is Encoding.CDR:
            data = data.replace(b"\0", b"?") + b"\0"
        self.uint32(len(data))
        self._body += data

    def message(self) -> bytes:
        """Return the message with its framing."""
        return self._encoding.prefix(len(self._body)) + self._body


def string_message(encoding: Encoding, text: str) -> bytes:
    """Return a std_msgs/String."""
    writer = MessageWriter(encoding)
    writer.string(text)
    return writer.message()


def read_string(encoding: Encoding, message: bytes, longest: int) -> str:
    """Return the text of a std_msgs/String; WireError if it is none, or longer than `longest`."""
    encoding.check_prefix(message)
    start = PREFIX + _LENGTH.size
    if len(message) < start:
        raise WireError("a text has a length")
    (length,) = _LENGTH.unpack_from(message, PREFIX)
    if length > longest:
        raise WireError(f"a text of {length} bytes is too long: {longest} at most")
    encoding.check_end(start + length, message)
    return message[start : start + length].rstrip(b"\0").decode(errors="replace")


def float64_message(encoding: Encoding, value: float) -> bytes:
    """Return a std_msgs/Float64."""
    return encoding.prefix(_F64.size) + _F64.pack(value)


def diagnostics_message(
    encoding: Encoding, seq: int, stamp: int, statuses: Sequence[Status]
) -> bytes:
    """Return a diagnostic_msgs/DiagnosticArray; `stamp` is wall time in ns."""
    writer = MessageWriter(encoding)
    if encoding is Encoding.ROS1:
        writer.uint32(seq)
    for part in divmod(stamp, 1_000_000_000):
        writer.uint32(part % (1 << 32))  # before 1970 as in ROS 2's int32, whatever the clock says
    writer.string("")
    writer.uint32(len(statuses))
    for status in statuses:
        _write_status(writer, status)
    return writer.message()


def _write_status(writer: MessageWriter, status: Status) -> None:
    writer.byte(status.level)
    for text in (status.name, status.message, "rtron"):
        writer.string(text)
    writer.uint32(len(status.values))
    for pair in status.values.items():
        for text in pair:
            writer.string(text)
