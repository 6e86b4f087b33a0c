"""The guarded nodes: found, asked in rounds, and found again when they have moved."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import partial

from rtron.errors import WireError
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.foreign_connections import ForeignConnection, parse_connections
from rtron.guard.audit.ros1.master_queries import WorkerThreads, resolve_node
from rtron.guard.audit.ros1.poll_schedule import PollSchedule, PollTarget
from rtron.guard.audit.ros1.xmlrpc_poller import ServerAddress, XmlRpcPoller, encode_call
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.printable import printable
from rtron.vocabulary import GUARD_NODE, SECOND, TopicAccess
from rtron.wire.ros1.ros_api import BusConnection
from rtron.wire.ros1.xmlrpc import decode_ros_reply

_REQUEST = encode_call("getBusInfo", GUARD_NODE)
_FIRST_RETRY, _LAST_RETRY = SECOND // 10, 2 * SECOND
_SHARE = 20


@dataclass(slots=True, kw_only=True, eq=False)
class AuditedNode:
    """A node that subscribes to the guard.

    `audited_topics` are the topics on which it matters who publishes to it. `connections` were read
    from the response `last_body`; `first_connections` are those of the first response from the
    node's present address, without ports, None before there is one. `last_response_at` is when it
    last answered well (ns), `failure` why it does not; `is_refused` tells that nothing listens at
    its address.
    """

    name: str
    audited_topics: dict[str, TopicAccess]
    poll_target: PollTarget
    last_response_at: int
    last_body: bytes = b""
    connections: frozenset[BusConnection] = frozenset()
    first_connections: frozenset[BusConnection] | None = None
    foreign_connections: frozenset[ForeignConnection] = frozenset()
    failure: str = "the master does not tell where it lives"
    is_refused: bool = False
    is_parsing: bool = False
    is_resolving: bool = False
    _retry_delay: int = field(default=_FIRST_RETRY)

    def note_success(self, now: int) -> None:
        """Note that the node has answered, and how."""
        self.last_response_at, self.failure, self.is_refused = now, "", False
        self._retry_delay = _FIRST_RETRY

    def note_first_connections(self, connections: frozenset[BusConnection]) -> None:
        """Keep what the first answer told."""
        if self.first_connections is None:
            self.first_connections = frozenset(replace(link, port=None) for link in connections)

    def note_failure(self, failure: str, now: int, *, is_refused: bool = False) -> None:
        """Note that it has not; it is asked again after a while, each time a longer one."""
        self.failure, self.is_refused = failure, is_refused
        self.poll_target.not_before = now + self._retry_delay
        self._retry_delay = min(2 * self._retry_delay, _LAST_RETRY)

    def limit_rate(self, work: int, now: int) -> None:
        """Ask the node less often if its answers are much work (ns): a twentieth of the time."""
        self.poll_target.not_before = max(self.poll_target.not_before, now + _SHARE * work)

    def reset_address(self) -> None:
        """Ask at another address at once."""
        self.poll_target.poller.close()
        self.poll_target.not_before = 0
        self.last_body = b""
        self.first_connections = None


def bus_info_poller() -> XmlRpcPoller:
    """Return what asks a node for its connections."""
    return XmlRpcPoller(_REQUEST)


_MAX_NODES = 512
_ParseResult = tuple[frozenset[BusConnection] | None, str, int]


class AuditedNodes:
    """Asks each guarded node who speaks to it; `heard` is told when a node's answer has changed.

    An answer that is the same, byte by byte, is not read again; others are read in a thread.
    """

    def __init__(
        self, loop: EventLoop, master: str, expected: ExpectedGraph, schedule: PollSchedule
    ) -> None:
        self.by_name: dict[str, AuditedNode] = {}
        self.on_change: Callable[[AuditedNode], None] = lambda node: None
        self._loop = loop
        self._master = master
        self._expected = expected
        self._schedule = schedule
        self._parser_threads = WorkerThreads(loop, "audit-read")
        self._resolver_threads = WorkerThreads(loop, "audit-find")

    def watch(self, names: Iterable[str]) -> None:
        """Audit these nodes from now on."""
        for name in names:
            if name not in self.by_name and len(self.by_name) < _MAX_NODES:
                self._add(name)

    def forget(self, node: AuditedNode) -> None:
        """Audit a node no more."""
        self._schedule.remove(node.poll_target)
        del self.by_name[node.name]
        self._update_connections(node, frozenset())

    def resolve(self, node: AuditedNode) -> None:
        """Ask the master where a node lives now."""
        if not node.is_resolving:
            work = partial(resolve_node, self._master, node.name)
            node.is_resolving = self._resolver_threads.submit(
                work, partial(self._on_resolved, node)
            )

    def close(self) -> None:
        """Ask nobody any more."""
        self._parser_threads.close()
        self._resolver_threads.close()

    def _add(self, name: str) -> None:
        target = PollTarget(
            poller=bus_info_poller(), on_response=lambda body: None, on_failure=lambda error: None
        )
        topics = self._expected.audited_topics(name)
        node = AuditedNode(
            name=name, audited_topics=topics, poll_target=target, last_response_at=self._loop.now()
        )
        target.on_response = partial(self._on_response, node)
        target.on_failure = partial(self._on_failure, node)
        self.by_name[name] = node
        self._schedule.add(target)
        self.resolve(node)

    def _on_resolved(self, node: AuditedNode, server: ServerAddress | None) -> None:
        node.is_resolving = False
        if server is not None and server != node.poll_target.server:
            node.poll_target.server = server
            node.reset_address()

    def _on_response(self, node: AuditedNode, body: bytes) -> None:
        if body is node.last_body and not node.failure:
            node.last_response_at = self._loop.now()
        elif body == node.last_body:
            node.note_success(self._loop.now())
        elif not node.is_parsing:
            done = partial(self._on_parsed, node, body)
            node.is_parsing = self._parser_threads.submit(partial(_parse, body), done)

    def _on_parsed(self, node: AuditedNode, body: bytes, result: _ParseResult) -> None:
        connections, failure, duration = result
        node.is_parsing = False
        now = self._loop.now()
        if self.by_name.get(node.name) is not node:
            return
        if connections is None:
            node.note_failure(failure, now)
            return
        node.last_body = body
        node.note_success(now)
        node.limit_rate(duration, now)
        node.note_first_connections(connections)
        self._update_connections(node, connections)

    def _on_failure(self, node: AuditedNode, error: Exception) -> None:
        is_refused = isinstance(error, ConnectionRefusedError)
        node.note_failure(printable(str(error)), self._loop.now(), is_refused=is_refused)
        self.resolve(node)
        if is_refused:
            node.last_body = b""
            self._update_connections(node, frozenset())

    def _update_connections(self, node: AuditedNode, connections: frozenset[BusConnection]) -> None:
        if connections != node.connections:
            node.connections = connections
            self.on_change(node)


def _parse(body: bytes) -> _ParseResult:
    """Read an answer; return the connections or what is wrong, and how long it took (ns)."""
    began = time.thread_time_ns()
    try:
        connections, failure = parse_connections(decode_ros_reply(body)), ""
    except WireError as error:
        connections, failure = None, printable(str(error))
    return connections, failure, time.thread_time_ns() - began
