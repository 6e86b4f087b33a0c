"""The connections that bring messages to a node, as its `getBusInfo` tells them.

A row is `[id, source, direction, transport, topic, connected, info]` (ROS wiki: Slave_API). Where
messages come in, `source` is the URI that the node was told by `publisherUpdate` and has dialled,
both in rospy and in roscpp: a publisher that never registered cannot hide it. rospy shows a row
before the connection stands. `info` names the port at the other end, the one that the publisher's
`requestTopic` gave. Where messages go out, `source` is only what the subscriber calls itself.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from rtron.errors import WireError
from rtron.wire.ros1.xmlrpc import decode_response

_SUCCESS = 1
_RESPONSE_PARTS = 3
_MIN_COLUMNS, _TOPIC_END, _INFO_COLUMN = 5, 5, 6
_PORT = re.compile(r" to \[.{0,255}:(\d{1,5})(?: on socket \d{1,10})?\]$")
_INCOMING = "i"


@dataclass(frozen=True, slots=True)
class BusConnection:
    """A connection that brings messages; `port` is the other end's, None if that is not told."""

    topic: str
    source: str
    port: int | None = None


def parse_bus_info_response(body: bytes) -> frozenset[BusConnection]:
    """Read the answer to getBusInfo; WireError if it has another shape or the node says no."""
    return parse_bus_info(parse_ros_response(body))


def parse_bus_info(rows: object) -> frozenset[BusConnection]:
    """Read the value of such an answer; WireError if it has another shape."""
    if not isinstance(rows, list):
        raise WireError("the bus info is not a list")
    return frozenset(_connections(rows))


def parse_ros_response(body: bytes) -> object:
    """Read the answer of a ROS API, `[code, message, value]`; WireError if it is none, or no."""
    answer = decode_response(body)
    if not isinstance(answer, list) or len(answer) != _RESPONSE_PARTS:
        raise WireError("the answer is not [code, message, value]")
    if answer[0] != _SUCCESS:
        raise WireError("the answer is no")
    return answer[2]


def normalise_uri(uri: str) -> str:
    """Return a URI as it is compared: a slash at the end does not count."""
    return uri.rstrip("/")


def _connections(rows: list[object]) -> Iterator[BusConnection]:
    for row in rows:
        if not isinstance(row, list) or len(row) < _MIN_COLUMNS:
            raise WireError("the bus info has a malformed entry")
        if not all(isinstance(part, str) for part in row[1:_TOPIC_END]):
            raise WireError("the bus info has a malformed entry")
        _, source, direction, _, topic, *_ = row
        if direction == _INCOMING:
            yield BusConnection(topic, normalise_uri(source), _port(row))


def _port(row: list[object]) -> int | None:
    info = row[_INFO_COLUMN] if len(row) > _INFO_COLUMN else ""
    found = _PORT.search(info) if isinstance(info, str) else None
    return int(found[1]) if found else None
