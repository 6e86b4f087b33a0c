"""The domain's graph as the guard needs it: who is on the topics it watches, told when it changes.

A thread waits for rcl's graph condition, since nothing else tells of changes; all else happens in
the loop's thread.
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
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.transport.ros2.graph_query import Listing
from rtron.vocabulary import GUARD_NODE, SECOND, Direction

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rtron.guard.core.event_loop import Loop
    from rtron.guard.transport.ros2.rcl import Rcl
    from rtron.wire.ros2.endpoints import Ros2Endpoint
    from rtron.wire.ros2.session import Session

log = logging.getLogger(__name__)

_PAUSE = SECOND // 50
_EVERY_S = 0.5
_LONGEST_WAIT_NS = 500_000_000
_REST = 4
"""So many times as long as the asking took."""
_LONGEST_REST = 2 * SECOND


@dataclass(frozen=True, slots=True)
class Ends:
    """Who publishes and who subscribes a topic, without ourselves."""

    publishers: tuple[Ros2Endpoint, ...] = ()
    subscribers: tuple[Ros2Endpoint, ...] = ()


_NOBODY = Ends()


class Graph:
    """Keeps what the domain says of each watched topic, and calls all of `changed` after news.

    Strangers who make endpoints without end cost not more than a part of the time: of each topic a
    bounded number is known, and after each asking the graph rests in proportion to its work.
    """

    def __init__(self, loop: Loop, session: Session, rcl: Rcl) -> None:
        self._loop = loop
        self._node = session.node(GUARD_NODE)
        self._listing, self._raw = Listing(self._node), Listing(self._node, raw=True)
        self._rcl = rcl
        self._ends: dict[str, Ends] = {}
        self.changed: list[Callable[[], None]] = []
        self.participant = session.participant(GUARD_NODE)
        """Which participant we are."""
        self._due = False
        self._ending = False
        self._looked: dict[str, int] = {}
        self._rests_until = 0
        self._seldom = Seldom()
        self._waker = implementation.GuardCondition(self._node.context.handle)
        self._waiter = threading.Thread(target=self._wait, args=(session,), daemon=True)
        self._waiter.start()
        atexit.register(self.close)  # the thread must not be in rcl when Python ends
        self._look_again()

    def watch(self, topic: str) -> None:
        """Know about a topic from now on; one without a slash in front is the middleware's own."""
        if topic not in self._ends:
            self._ends[topic] = _NOBODY
            self._soon()

    def ends(self, topic: str) -> Ends:
        """Return who is on a watched topic."""
        return self._ends.get(topic, _NOBODY)

    def watched(self) -> tuple[Ends, ...]:
        """Return who is on all the watched topics."""
        return tuple(self._ends.values())

    def is_own(self, gid: bytes) -> bool:
        """Tell whether an endpoint is one of ours."""
        return gid.startswith(self.participant)

    def look(self, topic: str) -> Ends:
        """Ask the domain about one topic now; whoever is new, is told to all soon.

        Asked again at once, or while it rests, it gives what it knows.
        """
        now = self._loop.now()
        if now < max(self._rests_until, self._looked.get(topic, -_PAUSE) + _PAUSE):
            return self.ends(topic)
        self._looked[topic] = now
        return self.ask(topic)

    def ask(self, topic: str) -> Ends:
        """Ask the domain about one topic, whatever it costs."""
        with self._resting_after():
            ends = self._asked(topic)
        if ends != self._ends.get(topic):
            self._ends[topic] = ends
            self._soon()
        return ends

    def refresh(self) -> None:
        """Ask the domain about every watched topic, and tell all of `changed`."""
        self._due = False
        if self._ending:
            return
        with self._resting_after():
            self._ends = {topic: self._asked(topic) for topic in self._ends}
        for changed in list(self.changed):
            _safely(changed)

    @contextmanager
    def _resting_after(self) -> Iterator[None]:
        """Leave time for all else after some work."""
        began = time.thread_time_ns()
        yield
        rest = min(_REST * (time.thread_time_ns() - began), _LONGEST_REST)
        self._rests_until = self._loop.now() + rest

    def _look_again(self) -> None:
        """Refresh at times, change or not: some things are decided by time alone."""
        if not self._ending:
            self._soon()
            self._loop.call_later(_EVERY_S, self._look_again)

    def close(self) -> None:
        """Ask and tell no more."""
        atexit.unregister(self.close)
        self._ending = True
        self._waker.trigger_guard_condition()
        self._waiter.join()

    def _asked(self, topic: str) -> Ends:
        """Return who is on a topic; who was, where that cannot be told."""
        known = self.ends(topic)
        try:
            return Ends(
                publishers=self._others(topic, Direction.PUBLISH, known.publishers),
                subscribers=self._others(topic, Direction.SUBSCRIBE, known.subscribers),
            )
        except WireError as error:
            if self._seldom.may_say(None, self._loop.now()):
                log.warning("%s", error)
            return known

    def _others(
        self, topic: str, direction: Direction, known: tuple[Ros2Endpoint, ...]
    ) -> tuple[Ros2Endpoint, ...]:
        listing = self._listing if topic.startswith("/") else self._raw
        return listing.ends(topic, direction, known, self.participant)

    def _soon(self) -> None:
        """Refresh in a moment: changes come in crowds."""
        if not self._due:
            self._due = True
            now = self._loop.now()
            self._loop.call_at(max(now + _PAUSE, self._rests_until), self.refresh)

    def _wait(self, session: Session) -> None:
        """Tell the loop of each change, until the end; in the thread of its own."""
        context = session.context.handle
        with context, self._node.handle:
            waiting = implementation.WaitSet(0, 2, 0, 0, 0, 0, context)
            while not self._ending:
                try:
                    changes = self._changes(waiting)
                except Exception:
                    log.exception("changes of the graph are only looked for twice a second now")
                    return
                if changes:
                    self._loop.post(self._soon)

    def _changes(self, waiting: Any) -> bool:  # noqa: ANN401 - rclpy's handle
        waiting.clear_entities()
        waiting.add_guard_condition(self._waker)
        self._rcl.watch_graph(waiting.pointer, self._node.handle.pointer)
        waiting.wait(_LONGEST_WAIT_NS)
        return bool(waiting.get_ready_entities("guard_condition"))


def _safely(changed: Callable[[], None]) -> None:
    """Call back; one that fails must not blind the others."""
    try:
        changed()
    except Exception:
        log.exception("internal error after a change of the graph")
