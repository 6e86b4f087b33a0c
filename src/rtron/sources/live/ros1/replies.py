"""What ROS 1's master and nodes answer, checked: a stranger's answer has any shape it likes."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from rtron.errors import WireError

Pair: TypeAlias = tuple[str, str]
_SIDES = 3
_TO_TOPIC = 5


@dataclass(frozen=True, slots=True)
class SystemState:
    """Who publishes, subscribes and serves what, as (name, node); `malformed` counts the rest."""

    publishers: tuple[Pair, ...] = ()
    subscribers: tuple[Pair, ...] = ()
    services: tuple[Pair, ...] = ()
    malformed: int = 0

    def nodes(self) -> tuple[str, ...]:
        """Return the names of all nodes, in order."""
        pairs = (*self.publishers, *self.subscribers, *self.services)
        return tuple(sorted({node for _, node in pairs}))


@dataclass(frozen=True, slots=True)
class Incoming:
    """A connection through which a node takes messages of a topic; `source` is an address."""

    topic: str
    source: str


def system_state(answer: object) -> SystemState:
    """Read the answer of getSystemState; WireError if it is not three lists."""
    if not isinstance(answer, list) or len(answer) != _SIDES:
        raise WireError("the system state is not three lists")
    publishers, subscribers, services = (_pairs(side) for side in answer)
    malformed = sum(side.count(None) for side in (publishers, subscribers, services))
    return SystemState(
        tuple(filter(None, publishers)),
        tuple(filter(None, subscribers)),
        tuple(filter(None, services)),
        malformed,
    )


def topic_types(answer: object) -> dict[str, str]:
    """Read the answer of getTopicTypes; a type that the master does not know is left out."""
    rows = answer if isinstance(answer, list) else []
    texts = (row for row in rows if _is_texts(row, 2))
    return {topic: type for topic, type in texts if type != "*"}


def incoming(answer: object) -> tuple[Incoming, ...]:
    """Read the connections of getBusInfo that bring messages; WireError if it has another shape."""
    if not isinstance(answer, list):
        raise WireError("the bus info is not a list")
    return tuple(_incoming(answer))


def process_id(answer: object) -> int:
    """Read the answer of getPid; WireError if no process can have that number."""
    if isinstance(answer, bool) or not isinstance(answer, int) or answer <= 0:
        raise WireError("the process id is not a positive number")
    return answer


def text(answer: object) -> str:
    """Read a text; WireError if it is something else."""
    if not isinstance(answer, str):
        raise WireError("the answer is not a text")
    return answer


def _pairs(side: object) -> list[Pair | None]:
    """Return the pairs of one side of the system state, None for what is malformed."""
    rows = side if isinstance(side, list) else [None]
    return [pair for row in rows for pair in _row(row)]


def _row(row: object) -> list[Pair | None]:
    if not isinstance(row, list) or len(row) != 2:  # noqa: PLR2004 - a name and its nodes
        return [None]
    name, nodes = row
    if not _is_name(name) or not isinstance(nodes, list):
        return [None]
    return [(name, node) if _is_name(node) else None for node in nodes]


def _incoming(rows: list[object]) -> Iterator[Incoming]:
    for row in rows:
        if not isinstance(row, list) or not _is_texts(row[1:_TO_TOPIC], _TO_TOPIC - 1):
            raise WireError("the bus info has a malformed entry")
        _, source, direction, _, topic, *more = row
        if direction == "i" and (not more or more[0]):
            yield Incoming(topic, source)


def _is_name(value: object) -> bool:
    return isinstance(value, str) and value != ""


def _is_texts(row: object, length: int) -> bool:
    return (
        isinstance(row, list) and len(row) == length and all(isinstance(each, str) for each in row)
    )
