"""The guarded nodes: found, asked in rounds, and found again when they have moved."""

import time
from collections.abc import Callable, Iterable
from functools import partial

from rtron.errors import WireError
from rtron.guard.audit.ros1.audited_node import GuardedNode, asker
from rtron.guard.audit.ros1.bus_info import Link, links_of
from rtron.guard.audit.ros1.expected_graph import Expectations
from rtron.guard.audit.ros1.master_queries import Threads, place_of
from rtron.guard.audit.ros1.poll_schedule import Asked, Rounds
from rtron.guard.audit.ros1.xmlrpc_poller import Place
from rtron.guard.core.event_loop import Loop
from rtron.guard.core.printable import shown

_MOST = 512
_Read = tuple[frozenset[Link] | None, str, int]


class GuardedNodes:
    """Asks each guarded node who speaks to it; `heard` is told when a node's answer has changed.

    An answer that is the same, byte by byte, is not read again; others are read in a thread.
    """

    def __init__(self, loop: Loop, master: str, expected: Expectations, rounds: Rounds) -> None:
        self.by_name: dict[str, GuardedNode] = {}
        self.heard: Callable[[GuardedNode], None] = lambda node: None
        self._loop = loop
        self._master = master
        self._expected = expected
        self._rounds = rounds
        self._readers = Threads(loop, "audit-read")
        self._finders = Threads(loop, "audit-find")

    def watch(self, names: Iterable[str]) -> None:
        """Audit these nodes from now on."""
        for name in names:
            if name not in self.by_name and len(self.by_name) < _MOST:
                self._add(name)

    def forget(self, node: GuardedNode) -> None:
        """Audit a node no more."""
        self._rounds.remove(node.asked)
        del self.by_name[node.name]
        self._hear(node, frozenset())

    def find(self, node: GuardedNode) -> None:
        """Ask the master where a node lives now."""
        if not node.looking:
            work = partial(place_of, self._master, node.name)
            node.looking = self._finders.submit(work, partial(self._found, node))

    def close(self) -> None:
        """Ask nobody any more."""
        self._readers.close()
        self._finders.close()

    def _add(self, name: str) -> None:
        asked = Asked(asker=asker(), answered=lambda body: None, failed=lambda error: None)
        heard = self._expected.heard(name)
        node = GuardedNode(name=name, heard=heard, asked=asked, seen=self._loop.now())
        asked.answered = partial(self._answered, node)
        asked.failed = partial(self._failed, node)
        self.by_name[name] = node
        self._rounds.add(asked)
        self.find(node)

    def _found(self, node: GuardedNode, place: Place | None) -> None:
        node.looking = False
        if place is not None and place != node.asked.place:
            node.asked.place = place
            node.moved()

    def _answered(self, node: GuardedNode, body: bytes) -> None:
        if body is node.body and not node.fault:
            node.seen = self._loop.now()
        elif body == node.body:
            node.answered_well(self._loop.now())
        elif not node.reading:
            done = partial(self._read, node, body)
            node.reading = self._readers.submit(partial(_links, body), done)

    def _read(self, node: GuardedNode, body: bytes, read: _Read) -> None:
        links, fault, took = read
        node.reading = False
        now = self._loop.now()
        if self.by_name.get(node.name) is not node:
            return
        if links is None:
            node.failed(fault, now)
            return
        node.body = body
        node.answered_well(now)
        node.took(took, now)
        node.said(links)
        self._hear(node, links)

    def _failed(self, node: GuardedNode, error: Exception) -> None:
        refused = isinstance(error, ConnectionRefusedError)
        node.failed(shown(str(error)), self._loop.now(), refused=refused)
        self.find(node)
        if refused:
            node.body = b""
            self._hear(node, frozenset())

    def _hear(self, node: GuardedNode, links: frozenset[Link]) -> None:
        if links != node.links:
            node.links = links
            self.heard(node)


def _links(body: bytes) -> _Read:
    """Read an answer; return the connections or what is wrong, and how long it took (ns)."""
    began = time.thread_time_ns()
    try:
        links, fault = links_of(body), ""
    except WireError as error:
        links, fault = None, shown(str(error))
    return links, fault, time.thread_time_ns() - began
