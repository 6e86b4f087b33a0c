"""Calls of ROS 1's Master and Slave API, and what they answer, checked (ROS wiki: Master_API).

Nodes are strangers: an answer has any shape it likes. All calls raise SourceError if nobody
answers within `timeout` seconds, or says no, and WireError if the answer has another shape.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

from rtron.errors import WireError
from rtron.wire.ros1.network import HOST_NETWORK, Network
from rtron.wire.ros1.xmlrpc import ros_call

NamedNode: TypeAlias = tuple[str, str]
_LIST_COUNT = 3
_TOPIC_END, _CONNECTED_COLUMN, _INFO_COLUMN = 5, 5, 6
_INCOMING = "i"
_PORT = re.compile(r" to \[.{0,255}:(\d{1,5})(?: on socket \d{1,10})?\]$")


@dataclass(frozen=True, slots=True)
class SystemState:
    """Who publishes, subscribes and serves what, as (name, node); `malformed` counts the rest."""

    publishers: tuple[NamedNode, ...] = ()
    subscribers: tuple[NamedNode, ...] = ()
    services: tuple[NamedNode, ...] = ()
    malformed: int = 0

    def nodes(self) -> tuple[str, ...]:
        """Return the names of all nodes, in order."""
        pairs = (*self.publishers, *self.subscribers, *self.services)
        return tuple(sorted({node for _, node in pairs}))


@dataclass(frozen=True, slots=True)
class BusConnection:
    """A connection that brings a node the messages of a topic.

    `source` is the URI that the node was told by `publisherUpdate` and has dialled, both in rospy
    and in roscpp: a publisher that never registered cannot hide it. `port` is the other end's, the
    one that the publisher's `requestTopic` gave, None if that is not told.
    """

    topic: str
    source: str
    port: int | None = None


def query_system_state(
    master: str, caller: str, timeout: float, network: Network = HOST_NETWORK
) -> SystemState:
    """Ask a master who publishes, subscribes and serves what."""
    return parse_system_state(
        ros_call(master, "getSystemState", caller, timeout=timeout, network=network)
    )


def query_node_uri(
    master: str, caller: str, node: str, timeout: float, network: Network = HOST_NETWORK
) -> str:
    """Ask a master for the address of a node."""
    return parse_text(
        ros_call(master, "lookupNode", caller, node, timeout=timeout, network=network)
    )


def query_process_id(uri: str, caller: str, timeout: float, network: Network = HOST_NETWORK) -> int:
    """Ask a node for its process id."""
    return parse_process_id(ros_call(uri, "getPid", caller, timeout=timeout, network=network))


def query_parent_id(uri: str, caller: str, timeout: float, network: Network = HOST_NETWORK) -> int:
    """Ask a node of the guard for the id of its parent process, which other nodes do not tell."""
    return parse_process_id(ros_call(uri, "getParentPid", caller, timeout=timeout, network=network))


def query_bus_info(
    uri: str, caller: str, timeout: float, network: Network = HOST_NETWORK
) -> object:
    """Ask a node for its connections; `parse_bus_info` reads the answer."""
    return ros_call(uri, "getBusInfo", caller, timeout=timeout, network=network)


def parse_system_state(reply: object) -> SystemState:
    """Read the answer of getSystemState; WireError if it is not three lists."""
    if not isinstance(reply, list) or len(reply) != _LIST_COUNT:
        raise WireError("the system state is not three lists")
    publishers, subscribers, services = (_pairs(side) for side in reply)
    malformed = sum(side.count(None) for side in (publishers, subscribers, services))
    return SystemState(
        tuple(filter(None, publishers)),
        tuple(filter(None, subscribers)),
        tuple(filter(None, services)),
        malformed,
    )


def parse_topic_types(reply: object) -> dict[str, str]:
    """Read the answer of getTopicTypes; a type that the master does not know is left out."""
    rows = reply if isinstance(reply, list) else []
    texts = (row for row in rows if _are_texts(row, 2))
    return {topic: type for topic, type in texts if type != "*"}


def parse_bus_info(reply: object, *, connected_only: bool = False) -> tuple[BusConnection, ...]:
    """Read the connections of getBusInfo that bring messages; WireError if it has another shape.

    A row is `[id, source, direction, transport, topic, connected, info]`. rospy shows one before
    the connection stands. Where messages go out, `source` is only what the subscriber calls itself.
    """
    rows = _connection_rows(reply)
    return tuple(_incoming_connections(rows, connected_only=connected_only))


def parse_bus_peers(reply: object) -> frozenset[NamedNode]:
    """Read whom one of the guard's nodes is connected to: topics, and names that are only claimed.

    The guard's own nodes give the publisher's name as the info of an incoming connection. WireError
    if the answer has another shape.
    """
    rows = _connection_rows(reply)
    named = ((row, row[1] if row[2] != _INCOMING else _info(row)) for row in rows)
    return frozenset((row[4], name) for row, name in named if _is_name(name))


def parse_process_id(reply: object) -> int:
    """Read the answer of getPid or getParentPid; WireError if no process can have that number."""
    if isinstance(reply, bool) or not isinstance(reply, int) or reply <= 0:
        raise WireError("the process id is not a positive number")
    return reply


def parse_text(reply: object) -> str:
    """Read a text; WireError if it is something else."""
    if not isinstance(reply, str):
        raise WireError("the answer is not a text")
    return reply


def _pairs(side: object) -> list[NamedNode | None]:
    """Return the pairs of one side of the system state, None for what is malformed."""
    rows = side if isinstance(side, list) else [None]
    return [pair for row in rows for pair in _parse_row(row)]


def _parse_row(row: object) -> list[NamedNode | None]:
    if not isinstance(row, list) or len(row) != 2:  # noqa: PLR2004 - a name and its nodes
        return [None]
    name, nodes = row
    if not _is_name(name) or not isinstance(nodes, list):
        return [None]
    return [(name, node) if _is_name(node) else None for node in nodes]


def _connection_rows(reply: object) -> list[list[Any]]:
    if not isinstance(reply, list):
        raise WireError("the bus info is not a list")
    for row in reply:
        if not isinstance(row, list) or not _are_texts(row[1:_TOPIC_END], _TOPIC_END - 1):
            raise WireError("the bus info has a malformed entry")
    return reply


def _incoming_connections(
    rows: list[list[Any]], *, connected_only: bool
) -> Iterator[BusConnection]:
    for row in rows:
        _, source, direction, _, topic, *_ = row
        is_connected = all(row[_CONNECTED_COLUMN:_INFO_COLUMN])
        if direction == _INCOMING and (is_connected or not connected_only):
            yield BusConnection(topic, source, _port(row))


def _info(row: list[Any]) -> str:
    info = row[_INFO_COLUMN] if len(row) > _INFO_COLUMN else ""
    return info if isinstance(info, str) else ""


def _port(row: list[Any]) -> int | None:
    found = _PORT.search(_info(row))
    return int(found[1]) if found else None


def _is_name(value: object) -> bool:
    return isinstance(value, str) and value != ""


def _are_texts(row: object, length: int) -> bool:
    return (
        isinstance(row, list) and len(row) == length and all(isinstance(each, str) for each in row)
    )
