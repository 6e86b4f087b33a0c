"""Looking at a ROS 2 domain once, from outside: as a participant that speaks to nobody."""

from __future__ import annotations

import os
import time
from contextlib import closing
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.audit.ros2.domain_probe import probe_shared_memory
from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
from rtron.guard.audit.ros2.observed_graph import ROSOUT_TOPIC, GraphReader, ObservedGraph
from rtron.guard.audit.ros2.verification import verify_ros2, verify_ros2_cell
from rtron.guard.cell.access import WATCH
from rtron.guard.cell.cell_report import verify_cells
from rtron.guard.cell.ros2.carrier_channel import CarrierChannel
from rtron.guard.cell.ros2.messages import FROM_CARRIER, Introduce, Look, Seen
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import SECOND, VERIFY_NODE, Direction
from rtron.wire.ros2.discovery_tuning import configure_cyclone, configure_fast_dds
from rtron.wire.ros2.domain_id import domain_address, domain_id
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE, Ros2Endpoint
from rtron.wire.ros2.service_names import is_service_topic

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.guard.cell.access import CellAccess
    from rtron.guard.cell.ros2.messages import FromCarrier, SeenEndpoint
    from rtron.vocabulary import Plan
    from rtron.vocabulary.verification import Verification

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


_POLL_S = 0.1
_QUIET_S = 3.5
"""Longer than the 3 s after which Fast DDS repeats an announcement."""
_MIN_WAIT_S = 15.0
_HELP = "is the app running? see ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, RMW_IMPLEMENTATION"
_HELP_RCLPY = "pip install rtron[ros2], or source your ROS"


def verify_domain(plan: Plan, timeout: float, domain: int | None = None) -> Verification:
    """Audit the app that runs in a domain (None: the environment's), once its graph has settled.

    That is when nothing has changed for 3.5 s, within `timeout` seconds and at least 15. The same
    is done in each cell. SourceError if there is no rclpy, nobody in the domain, or no end of
    changes: what was missed could be what is wrong.
    """
    limit = max(timeout, _MIN_WAIT_S)
    outside = verify_ros2(plan, _observe(plan, limit, domain))
    look = partial(_look_inside, plan, limit, domain_id(domain))
    return verify_cells(plan, domain_address(domain), outside, look)


def _observe(plan: Plan, limit: float, domain: int | None) -> ObservedGraph:
    """Return what is in a domain, as a participant there."""
    try:
        from rtron.guard.transport.ros2.abi_check import check_endpoint_info  # noqa: PLC0415
        from rtron.wire.ros2.session import Ros2Session, rmw_identifier  # noqa: PLC0415
    except ImportError as error:
        raise SourceError("ROS 2 is not there: no rclpy", help=_HELP_RCLPY) from error
    configure_fast_dds(rmw_identifier(), shares_memory=False)
    configure_cyclone()
    with closing(Ros2Session(domain, VERIFY_NODE)) as session:
        check_endpoint_info(session.node(VERIFY_NODE))
        return _wait_until_settled(GraphReader(session.node(VERIFY_NODE)), _topics(plan), limit)


def _look_inside(plan: Plan, limit: float, domain: int, access: CellAccess) -> Verification:
    """Compare the plan with what is in a cell, and try as root whether shared memory leads there.

    An ordinary user can make no network of its own to try from.
    """
    topics = tuple(topic for topic in _topics(plan) if not is_service_topic(topic))
    with closing(CellReader(access)) as reader:
        inside = _wait_until_settled(reader, topics, limit)
    found = verify_ros2_cell(plan, inside)
    if os.getuid():
        return found
    reached = find_by_shared_memory(domain, inside)
    where = f"in the cell of {access.node}"
    problems = tuple(f"{each} {where} is reached by shared memory" for each in reached)
    proven = (f"by shared memory, nobody {where} is reached from another network",)
    return replace(found, problems=problems, proven=() if reached else proven)


def _topics(plan: Plan) -> tuple[str, ...]:
    return (*ExpectedGraph(plan).topics, ROSOUT_TOPIC)


def _wait_until_settled(
    reader: GraphReader | CellReader, topics: tuple[str, ...], limit: float
) -> ObservedGraph:
    started = changed = time.monotonic()
    last_state: object = None
    while (now := time.monotonic()) - started < limit and now - changed < _QUIET_S:
        state = (tuple(reader.endpoints(topics)), reader.nodes())
        if state != last_state or not set(state[1]) - {VERIFY_NODE}:
            last_state, changed = state, now
        time.sleep(_POLL_S)
    observed = reader.snapshot(topics)
    if not set(observed.nodes) - {VERIFY_NODE}:
        raise SourceError("nothing can be verified: nobody is in the ROS 2 domain", help=_HELP)
    if now - changed < _QUIET_S:
        message = f"nothing can be verified: the graph still changes after {limit:g} s"
        raise SourceError(
            message, help="wait until the app has started, or give a longer --timeout"
        )
    return observed


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
