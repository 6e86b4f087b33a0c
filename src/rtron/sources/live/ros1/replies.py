"""What ROS 1's master and nodes answer, checked: a stranger's answer has any shape it likes."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from rtron.errors import WireError

NamedNode: TypeAlias = tuple[str, str]
_LIST_COUNT = 3
_TOPIC_FIELDS = 5


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
class IncomingConnection:
    """A connection that brings a node the messages of a topic; `publisher_uri` is an address."""

    topic: str
    publisher_uri: str


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


def parse_bus_info(reply: object) -> tuple[IncomingConnection, ...]:
    """Read the connections of getBusInfo that bring messages; WireError if it has another shape."""
    if not isinstance(reply, list):
        raise WireError("the bus info is not a list")
    return tuple(_incoming_connections(reply))


def parse_process_id(reply: object) -> int:
    """Read the answer of getPid; WireError if no process can have that number."""
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


def _incoming_connections(rows: list[object]) -> Iterator[IncomingConnection]:
    for row in rows:
        if not isinstance(row, list) or not _are_texts(row[1:_TOPIC_FIELDS], _TOPIC_FIELDS - 1):
            raise WireError("the bus info has a malformed entry")
        _, source, direction, _, topic, *more = row
        if direction == "i" and (not more or more[0]):
            yield IncomingConnection(topic, source)


def _is_name(value: object) -> bool:
    return isinstance(value, str) and value != ""


def _are_texts(row: object, length: int) -> bool:
    return (
        isinstance(row, list) and len(row) == length and all(isinstance(each, str) for each in row)
    )
