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
_ANSWER = 3
_LEAST, _TO_TOPIC, _INFO = 5, 5, 6
_PORT = re.compile(r" to \[.{0,255}:(\d{1,5})(?: on socket \d{1,10})?\]$")
_INCOMING = "i"


@dataclass(frozen=True, slots=True)
class Link:
    """A connection that brings messages; `port` is the other end's, None if that is not told."""

    topic: str
    source: str
    port: int | None = None


def links_of(body: bytes) -> frozenset[Link]:
    """Read the answer to getBusInfo; WireError if it has another shape or the node says no."""
    return links_in(value_of(body))


def links_in(rows: object) -> frozenset[Link]:
    """Read the value of such an answer; WireError if it has another shape."""
    if not isinstance(rows, list):
        raise WireError("the bus info is not a list")
    return frozenset(_links(rows))


def value_of(body: bytes) -> object:
    """Read the answer of a ROS API, `[code, message, value]`; WireError if it is none, or no."""
    answer = decode_response(body)
    if not isinstance(answer, list) or len(answer) != _ANSWER:
        raise WireError("the answer is not [code, message, value]")
    if answer[0] != _SUCCESS:
        raise WireError("the answer is no")
    return answer[2]


def plain(uri: str) -> str:
    """Return a URI as it is compared: a slash at the end does not count."""
    return uri.rstrip("/")


def _links(rows: list[object]) -> Iterator[Link]:
    for row in rows:
        if not isinstance(row, list) or len(row) < _LEAST:
            raise WireError("the bus info has a malformed entry")
        if not all(isinstance(part, str) for part in row[1:_TO_TOPIC]):
            raise WireError("the bus info has a malformed entry")
        _, source, direction, _, topic, *_ = row
        if direction == _INCOMING:
            yield Link(topic, plain(source), _port(row))


def _port(row: list[object]) -> int | None:
    told = row[_INFO] if len(row) > _INFO else ""
    found = _PORT.search(told) if isinstance(told, str) else None
    return int(found[1]) if found else None
