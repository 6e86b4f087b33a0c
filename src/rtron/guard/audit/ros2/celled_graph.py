"""Looking into a cell of ROS 2: what its carrier tells, and whether shared memory leads there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.audit.ros2.domain_probe import probe_shared_memory
from rtron.guard.audit.ros2.observed_graph import ObservedGraph
from rtron.guard.cell.access import WATCH
from rtron.guard.cell.ros2.carrier_channel import CarrierChannel
from rtron.guard.cell.ros2.messages import FROM_CARRIER, Introduce, Look, Seen
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import SECOND, Direction
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE, Ros2Endpoint

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.guard.cell.access import CellAccess
    from rtron.guard.cell.ros2.messages import FromCarrier, SeenEndpoint

_LIMIT = 10 * SECOND
"""How long a carrier may take to answer: it may just be starting."""


class CellReader:
    """Asks a carrier as `GraphReader` asks our participant; SourceError if there is no answer."""

    def __init__(self, access: CellAccess) -> None:
        self._node = access.node
        self._seen: Seen | None = None
        self._is_open = True
        self._loop = EventLoop()
        self._channel = CarrierChannel(
            self._loop,
            access.connect_carrier(),
            FROM_CARRIER,
            self._receive,
            lambda _: None,
            self._lose,
        )
        self._channel.send(Introduce(WATCH.decode()))

    def endpoints(self, topics: Iterable[str]) -> Iterator[Ros2Endpoint]:
        """Yield the endpoints of topics as they are now."""
        self._look(tuple(topics))
        yield from map(_endpoint, self._seen.endpoints if self._seen else ())

    def nodes(self) -> tuple[str, ...]:
        """Return the nodes that were there at the last look."""
        return self._seen.nodes if self._seen else ()

    def snapshot(self, topics: Iterable[str]) -> ObservedGraph:
        """Return all there is."""
        return ObservedGraph(tuple(self.endpoints(topics)), self.nodes())

    def close(self) -> None:
        """Leave the carrier, which then ends."""
        self._channel.close()
        self._loop.close()

    def _look(self, topics: tuple[str, ...]) -> None:
        self._seen = None
        self._channel.send(Look(topics))
        until = self._loop.now() + _LIMIT
        while self._is_open and self._seen is None and self._loop.now() < until:
            self._loop.step((until - self._loop.now()) / SECOND)
        if self._seen is None:
            raise SourceError(f"no carrier in the cell of {self._node} answers")

    def _receive(self, message: FromCarrier) -> None:
        if isinstance(message, Seen):
            self._seen = message

    def _lose(self) -> None:
        self._is_open = False


def find_by_shared_memory(domain: int, inside: ObservedGraph) -> list[str]:
    """Return who of a cell is seen by a stranger beside it who has the machine's /dev/shm alone."""
    own = {each.participant for each in inside.endpoints}
    found = probe_shared_memory(domain, sorted({each.topic for each in inside.endpoints}))
    seen = (each for each in found.endpoints if each.gid[:PARTICIPANT_SIZE] in own)
    return sorted({each.node or each.topic for each in seen})


def _endpoint(seen: SeenEndpoint) -> Ros2Endpoint:
    try:
        gid = bytes.fromhex(seen.gid)
    except ValueError:
        raise SourceError(f"a carrier tells {seen.gid[:40]!r} for a GID") from None
    return Ros2Endpoint(
        topic=seen.topic,
        direction=Direction.PUBLISH if seen.is_publisher else Direction.SUBSCRIBE,
        node=seen.node,
        type=seen.type,
        type_hash="",
        gid=gid,
        qos=seen.qos,
    )
