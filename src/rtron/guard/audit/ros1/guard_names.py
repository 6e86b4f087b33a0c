"""The guard's own names: a second node that takes one is found, and the name taken back.

The master lets the newest owner of a name have it, tells subscribers to go there, and asks the
one before to shut down (rosmaster, `_register_node_api`).
"""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from rtron.guard.audit.common.audit_response import AuditResponse
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.foreign_connections import normalise_uri
from rtron.guard.audit.ros1.guard_nodes import GuardNodes
from rtron.guard.audit.ros1.master_queries import WorkerThreads, query_uri, refuses_connections
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.printable import printable
from rtron.guard.node_shutdown import ShutdownRefusal
from rtron.vocabulary import Alarm, AlarmKind

log = logging.getLogger(__name__)

_REPLACED = "new node registered with same name"
_MAX_TAKEOVERS = 256


@dataclass(frozen=True, slots=True)
class _Takeover:
    uri: str
    alarm: Alarm


class GuardNames:
    """Asks the master who has the guard's names; an address where nobody listens does not count."""

    def __init__(
        self,
        loop: EventLoop,
        master: str,
        guard: GuardNodes,
        expected: ExpectedGraph,
        response: AuditResponse,
        takeover_uris: dict[str, str],
    ) -> None:
        """`takeover_uris` is filled with the addresses that had one of the names, and which."""
        self._loop = loop
        self._master = master
        self._guard = guard
        self._expected = expected
        self._response = response
        self._takeover_uris = takeover_uris
        self._threads = WorkerThreads(loop, "audit-names", 2)
        self._is_checking = False
        self._log_throttle = LogThrottle()
        self._refusal = ShutdownRefusal(loop)
        self._takeovers: dict[str, _Takeover] = {}
        self._checked: dict[str, str] = {}

    @property
    def has_takeover(self) -> bool:
        """Tell whether somebody has one of the names."""
        return bool(self._takeovers)

    @property
    def is_checked(self) -> bool:
        """Whether the master has told who has each name that the guard has now."""
        return self._checked == self._guard.node_uris()

    def check(self) -> None:
        """Ask for all names, unless that is being done."""
        if not self._is_checking:
            addresses = self._guard.node_uris()
            work = partial(_owners, self._master, addresses)
            self._is_checking = self._threads.submit(work, partial(self._on_checked, addresses))

    def update(self) -> None:
        """Ask again since the guard's nodes are others; an alarm about one of them was mistaken."""
        takeovers = self._takeovers.items()
        for node in [name for name, each in takeovers if self._is_ours(name, each.uri)]:
            takeover = self._takeovers.pop(node)
            self._takeover_uris.pop(normalise_uri(takeover.uri), None)
            self._response.withdraw(takeover.alarm)
        self.check()

    def handle_shutdown(self, node: str, reason: str) -> None:
        """Refuse to shut a node down; if the master asks since its name was taken, take it back."""
        if _REPLACED not in reason:
            self._refusal.handle(node, reason)
            return
        if self._log_throttle.allows(node, self._loop.now()):
            log.error("%s is not shut down: its name was taken", node)
        addresses = {name: uri for name, uri in self._guard.node_uris().items() if name == node}

        def answered(owners: Mapping[str, str]) -> None:
            self._report(owners)
            if self._response.stops_streams:
                self._guard.register_node(node)

        self._threads.submit(partial(_owners, self._master, addresses), answered)

    def close(self) -> None:
        """Ask nothing any more."""
        self._threads.close()

    def _on_checked(self, addresses: dict[str, str], owners: Mapping[str, str]) -> None:
        """Settle what the master has said that it is over, and nothing about other names."""
        self._is_checking = False
        self._checked = {name: addresses[name] for name in owners}
        for node in [name for name in self._takeovers if owners.get(name) == ""]:
            self._response.settle(self._takeovers.pop(node).alarm)
        self._report(owners)
        if addresses != self._guard.node_uris():
            self.check()

    def _report(self, owners: Mapping[str, str]) -> None:
        """Tell who has a name of ours, unless a process of ours has come or gone meanwhile."""
        ours = self._guard.node_uris()
        for node, uri in owners.items():
            if uri and node in ours and not self._is_ours(node, uri):
                self._raise_alarm(node, uri)

    def _raise_alarm(self, node: str, uri: str) -> None:
        before = self._takeovers.get(node)
        self._takeovers[node] = after = _Takeover(uri, _alarm(node, uri))
        if len(self._takeover_uris) < _MAX_TAKEOVERS:
            self._takeover_uris[normalise_uri(uri)] = node
        self._response.raise_(after.alarm, self._loop.now(), *self._guarded(node))
        if before and before.alarm != after.alarm:
            self._response.settle(before.alarm)
        if self._response.stops_streams:
            self._guard.register_node(node)

    def _is_ours(self, node: str, uri: str) -> bool:
        return normalise_uri(self._guard.node_uris().get(node, "")) == normalise_uri(uri)

    def _guarded(self, node: str) -> tuple[str, ...]:
        """Return the streams on which a name, not a pattern, may publish; all if there are none.

        Where else the other one has registered nobody sees once the name is taken back.
        """
        topics = self._expected.topics.values()
        named = {topic.stream_topic for topic in topics if node in topic.publishers}
        return tuple(named or {topic.stream_topic for topic in topics})


def _alarm(node: str, uri: str) -> Alarm:
    reason = f"{printable(uri)} has taken the name {node}"
    return Alarm(kind=AlarmKind.IMPOSTOR, reason=reason, node=node, peer=printable(uri))


def _owners(master: str, addresses: Mapping[str, str]) -> dict[str, str]:
    """Return where somebody else lives who has a name of ours, "" if nobody has.

    A name is left out if the master does not answer.
    """
    found = {}
    for node, address in addresses.items():
        uri = query_uri(master, node)
        if uri is not None:
            is_other = uri and normalise_uri(uri) != normalise_uri(address)
            found[node] = uri if is_other and not refuses_connections(uri) else ""
    return found
