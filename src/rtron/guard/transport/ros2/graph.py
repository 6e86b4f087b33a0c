"""The endpoints on the topics that the guard watches, updated when the ROS 2 graph changes.

A thread waits for rcl's graph condition, the only notice of changes. All else runs in the loop's
thread.
"""

from __future__ import annotations

import atexit
import logging
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rclpy.impl.implementation_singleton import rclpy_implementation as implementation

from rtron.errors import WireError
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.transport.ros2.graph_query import GraphQuery
from rtron.vocabulary import GUARD_NODE, SECOND, Direction

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.rcl import Rcl
    from rtron.wire.ros2.endpoints import Ros2Endpoint
    from rtron.wire.ros2.session import Ros2Session

log = logging.getLogger(__name__)

_QUERY_PERIOD = SECOND // 50
_REFRESH_PERIOD_S = 0.5
_LONGEST_WAIT_NS = 500_000_000
_IDLE_FACTOR = 4
"""The idle time after a query, as a multiple of the query's time."""
_MAX_IDLE = 2 * SECOND


@dataclass(frozen=True, slots=True)
class TopicEndpoints:
    """The publishers and subscribers of a topic, without our own and those of guards before."""

    publishers: tuple[Ros2Endpoint, ...] = ()
    subscribers: tuple[Ros2Endpoint, ...] = ()


_NO_ENDPOINTS = TopicEndpoints()


class RosGraph:
    """Keeps the endpoints of each watched topic, and calls all `listeners` after each refresh.

    Strangers who create endpoints without end cost only a part of the time: the number of endpoints
    of a topic is bounded, and after each query the graph is idle in proportion to its work.
    """

    def __init__(
        self, loop: EventLoop, session: Ros2Session, rcl: Rcl, node: str = GUARD_NODE
    ) -> None:
        self._loop = loop
        self._node = session.node(node)
        self._graph_query, self._raw_graph_query = (
            GraphQuery(self._node),
            GraphQuery(self._node, raw=True),
        )
        self._rcl = rcl
        self._endpoints: dict[str, TopicEndpoints] = {}
        self.listeners: list[Callable[[], None]] = []
        self.participant = session.participant(node)
        """The guard's own participant."""
        self.ended: frozenset[bytes] = frozenset()
        """The participants of the guards before: killed, they stay in the graph for a while."""
        self.is_current = False
        """Whether every query since the last refresh began has succeeded."""
        self._is_refresh_due = False
        self._is_closing = False
        self._last_queries: dict[str, int] = {}
        self._idle_until = 0
        self._log_throttle = LogThrottle()
        self._stop_condition = implementation.GuardCondition(self._node.context.handle)
        self._wait_thread = threading.Thread(
            target=self._wait_for_changes, args=(session,), daemon=True
        )
        self._wait_thread.start()
        atexit.register(self.close)  # the thread must not be in rcl when Python exits
        self._refresh_periodically()

    def watch(self, topic: str) -> None:
        """Watch a topic from now on; a name without a leading slash is the middleware's own."""
        if topic not in self._endpoints:
            self._endpoints[topic] = _NO_ENDPOINTS
            self._refresh_soon()

    def endpoints(self, topic: str) -> TopicEndpoints:
        """Return the endpoints on a watched topic."""
        return self._endpoints.get(topic, _NO_ENDPOINTS)

    def watched_endpoints(self) -> tuple[TopicEndpoints, ...]:
        """Return the endpoints on all watched topics."""
        return tuple(self._endpoints.values())

    def is_own(self, gid: bytes) -> bool:
        """Return whether an endpoint is one of ours."""
        return gid.startswith(self.participant)

    def query_if_due(self, topic: str) -> TopicEndpoints:
        """Query one topic now; listeners learn of changes soon.

        Soon after the last query, or while the graph is idle, return the known endpoints.
        """
        now = self._loop.now()
        if now < max(
            self._idle_until, self._last_queries.get(topic, -_QUERY_PERIOD) + _QUERY_PERIOD
        ):
            return self.endpoints(topic)
        self._last_queries[topic] = now
        return self.query(topic)

    def query(self, topic: str) -> TopicEndpoints:
        """Query one topic, whatever it costs."""
        with self._pause_afterwards():
            endpoints = self._query_endpoints(topic)
        if endpoints != self._endpoints.get(topic):
            self._endpoints[topic] = endpoints
            self._refresh_soon()
        return endpoints

    def refresh(self) -> None:
        """Query every watched topic, and call all listeners."""
        self._is_refresh_due = False
        if self._is_closing:
            return
        self.is_current = True
        with self._pause_afterwards():
            self._endpoints = {topic: self._query_endpoints(topic) for topic in self._endpoints}
        for listener in list(self.listeners):
            _call_safely(listener)

    @contextmanager
    def _pause_afterwards(self) -> Iterator[None]:
        """Be idle for a while after some work, to leave time for all else."""
        began = time.thread_time_ns()
        yield
        rest = min(_IDLE_FACTOR * (time.thread_time_ns() - began), _MAX_IDLE)
        self._idle_until = self._loop.now() + rest

    def _refresh_periodically(self) -> None:
        """Refresh at times without a change, too: some decisions depend on time alone."""
        if not self._is_closing:
            self._refresh_soon()
            self._loop.call_later(_REFRESH_PERIOD_S, self._refresh_periodically)

    def close(self) -> None:
        """Stop the queries and the thread."""
        atexit.unregister(self.close)
        self._is_closing = True
        self._stop_condition.trigger_guard_condition()
        self._wait_thread.join()

    def _query_endpoints(self, topic: str) -> TopicEndpoints:
        """Return the endpoints on a topic; those known before, if the query fails."""
        known = self.endpoints(topic)
        try:
            return TopicEndpoints(
                publishers=self._other_endpoints(topic, Direction.PUBLISH, known.publishers),
                subscribers=self._other_endpoints(topic, Direction.SUBSCRIBE, known.subscribers),
            )
        except WireError as error:
            self.is_current = False
            if self._log_throttle.allows(None, self._loop.now()):
                log.warning("%s", error)
            return known

    def _other_endpoints(
        self, topic: str, direction: Direction, known: tuple[Ros2Endpoint, ...]
    ) -> tuple[Ros2Endpoint, ...]:
        listing = self._graph_query if topic.startswith("/") else self._raw_graph_query
        return listing.endpoints(topic, direction, known, {self.participant, *self.ended})

    def _refresh_soon(self) -> None:
        """Refresh in a moment: changes come in groups."""
        if not self._is_refresh_due:
            self._is_refresh_due = True
            now = self._loop.now()
            self._loop.call_at(max(now + _QUERY_PERIOD, self._idle_until), self.refresh)

    def _wait_for_changes(self, session: Ros2Session) -> None:
        """Post each change to the loop, until the end; runs in a thread of its own."""
        context = session.context.handle
        with context, self._node.handle:
            wait_set = implementation.WaitSet(0, 2, 0, 0, 0, 0, context)
            while not self._is_closing:
                try:
                    changes = self._has_changed(wait_set)
                except Exception:
                    log.exception("changes of the graph are found only twice a second from now on")
                    return
                if changes:
                    self._loop.post(self._refresh_soon)

    def _has_changed(self, wait_set: Any) -> bool:  # noqa: ANN401 - rclpy's handle
        wait_set.clear_entities()
        wait_set.add_guard_condition(self._stop_condition)
        self._rcl.add_graph_condition(wait_set.pointer, self._node.handle.pointer)
        wait_set.wait(_LONGEST_WAIT_NS)
        return bool(wait_set.get_ready_entities("guard_condition"))


def _call_safely(listener: Callable[[], None]) -> None:
    """Call back; a listener that fails must not keep the others from their calls."""
    try:
        listener()
    except Exception:
        log.exception("internal error after a change of the graph")
