"""Strangers at guarded nodes: found out about, told, and driven out where the plan says so."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

from rtron.guard.audit.common.audit_response import AuditResponse, ListenToPublisher
from rtron.guard.audit.common.guard_inputs import matches_any
from rtron.guard.audit.ros1.audited_nodes import AuditedNode, AuditedNodes
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.foreign_connections import (
    ForeignConnection,
    NodeAddresses,
    PeerIdentity,
    foreign_connection_alarm,
    foreign_connections,
    normalise_uri,
    planned_sources,
)
from rtron.guard.audit.ros1.guard_nodes import GuardNodes
from rtron.guard.audit.ros1.master_queries import (
    WorkerThreads,
    identify_peer,
    refuses_connections,
    send_call,
)
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.printable import printable
from rtron.vocabulary import SECOND, Alarm

_PATIENCE_S = 0.03
"""How long an alarm waits for the master to say who it is."""
_EXCUSED = 5 * SECOND
"""How long a dead guard's or supervisor's address may still stand in a subscriber's list."""
_MISTAKE_LIMIT = 10 * SECOND
"""How long (ns) a stranger may turn out to be a planned publisher; later it has taken the name."""
_RETRY_S = 0.2
_DISCONNECT_PERIOD_S = 1.0
_KEEP_PERIOD, _KEEP_DURATION = SECOND // 100, SECOND
_ANSWER_DELAY = SECOND // 50
"""An answer that came sooner after a loss may have been given before it (ns)."""
_MAX_DUPLICATES = 64
_MAX_PER_NODE = 16
"""How many strangers at one node are dealt with at a time; the others when these are gone."""


@dataclass(slots=True, eq=False)
class _Intrusion:
    since: int
    identity: PeerIdentity | None = None
    alarm: Alarm | None = None
    is_retry_scheduled: bool = False


class Intrusions:
    """Keeps a case for each stranger, from when a node's answer shows it until it does no more.

    A subscriber may keep the address of a guard or supervisor that is dead, until the master tells
    it of the next one. So an address where nobody listens is looked at again, for 5 s at most,
    when the guard has just begun and the node's first answer had it, or when it was a planned
    publisher's. Nothing else is excused.
    """

    def __init__(
        self,
        loop: EventLoop,
        master: str,
        guard: GuardNodes,
        expected: ExpectedGraph,
        audited_nodes: AuditedNodes,
        response: AuditResponse,
        takeover_uris: Mapping[str, str],
    ) -> None:
        """Take `takeover_uris`: the name of the guard's that the node at each address had."""
        self._loop = loop
        self._master = master
        self._guard = guard
        self._expected = expected
        self._audited_nodes = audited_nodes
        self._response = response
        self._takeover_uris = takeover_uris
        self._addresses = NodeAddresses({})
        self._intrusions: dict[ForeignConnection, _Intrusion] = {}
        self._duplicate_uris: set[str] = set()
        self._lost_at: dict[tuple[str, str], int] = {}
        self._unanswered_calls: set[tuple[str, str]] = set()
        self._started_at = loop.now()
        self._query_threads = WorkerThreads(loop, "audit-ask", 2)
        self._call_threads = WorkerThreads(loop, "audit-tell", 2)

    @property
    def addresses(self) -> NodeAddresses:
        """Whose an address is; the guard's own are what they are at this moment."""
        self._addresses.guard_addresses = {
            uri.rstrip("/"): node for node, uri in self._guard.node_uris().items()
        }
        self._addresses.ports = self._guard.ports
        self._addresses.former_guard_uris = frozenset(map(normalise_uri, self._guard.former_uris()))
        return self._addresses

    def unidentified(self) -> str:
        """Return the address of a stranger that is not identified or is excused, "" if none is."""
        return next(
            (printable(f.connection.source) for f, i in self._intrusions.items() if not i.alarm), ""
        )

    def update(self, node: AuditedNode) -> None:
        """Look at whom a node hears; what it hears no more is settled.

        Who is still there, and is no stranger any more, never was one. While a process of the guard
        has not told its nodes, nobody new is judged on its streams, and who was found stays.
        """
        self._learn_listener(node)
        unknown = self._guard.unknown_streams()
        found = frozenset(
            each
            for each in foreign_connections(
                node.name, node.connections, node.audited_topics, self.addresses
            )
            if each.guarded not in unknown or each in node.foreign_connections
        )
        ended, known = node.foreign_connections - found, node.foreign_connections & found
        new = list(islice(found - known, _MAX_PER_NODE - len(known)))
        node.foreign_connections = known.union(new)
        connections = {replace(each, port=None) for each in node.connections}
        for foreign in ended:
            self._close_intrusion(foreign, is_planned=foreign.connection in connections)
        for foreign in new:
            self._open_intrusion(foreign)
        for topic in {foreign.connection.topic for foreign in found}:
            self.keep_listener(node.name, topic)

    def _learn_listener(self, node: AuditedNode) -> None:
        """Know a node that may hear itself, as an action server does, by where it is asked."""
        server = node.poll_target.server
        if server and any(each.may_publish(node.name) for each in node.audited_topics.values()):
            uri = normalise_uri(server.uri)
            if self.addresses.address_of(node.name) != uri:
                self.learn_publisher(node.name, uri)

    def keep_listener(self, name: str, topic: str) -> None:
        """Tell a node that has left us whom it may hear: an intruder may have sent it away.

        roscpp obeys whoever calls it last, so it is called at once, and for a second every 10 ms
        until it says itself that it hears us: a subscriber may give itself any name.
        """
        if self._stream_of(topic) not in self._response.stopped_streams:
            return
        is_new = (name, topic) not in self._lost_at
        self._lost_at[name, topic] = self._loop.now()
        if is_new:
            self._keep(name, topic)

    def _keep(self, name: str, topic: str) -> None:
        node, now = self._audited_nodes.by_name.get(name), self._loop.now()
        if node is None or self._has_returned(node, topic, now):
            del self._lost_at[name, topic]
            return
        self._loop.call_at(now + _KEEP_PERIOD, partial(self._keep, name, topic))
        self._send_publishers(node, topic)

    def _has_returned(self, node: AuditedNode, topic: str, now: int) -> bool:
        """Tell whether a node hears us again, or has not for so long that it is given up."""
        lost_at = self._lost_at[node.name, topic]
        has_answered = node.last_response_at - lost_at >= _ANSWER_DELAY
        own = {normalise_uri(uri) for uri in self._guard.node_uris().values()}
        sources = {each.source for each in node.connections if each.topic == topic}
        return now - lost_at >= _KEEP_DURATION or (has_answered and bool(sources & own))

    def update_all(self) -> None:
        """Look at all nodes again: what is known of the guard's own nodes has changed."""
        for node in list(self._audited_nodes.by_name.values()):
            self.update(node)

    def close(self) -> None:
        """Begin nothing any more."""
        self._query_threads.close()
        self._call_threads.close()

    def _close_intrusion(self, foreign: ForeignConnection, *, is_planned: bool) -> None:
        """Take an alarm back. A mistake shows soon: later, an intruder has got a planned name."""
        intrusion = self._intrusions.pop(foreign, None)
        is_young = intrusion and self._loop.now() - intrusion.since < _MISTAKE_LIMIT
        if intrusion and intrusion.alarm and is_planned and is_young:
            self._response.withdraw(intrusion.alarm)
        elif intrusion and intrusion.alarm:
            self._response.settle(intrusion.alarm)

    def _open_intrusion(self, foreign: ForeignConnection) -> None:
        intrusion = self._intrusions[foreign] = _Intrusion(self._loop.now())
        self._identify(foreign, intrusion)
        self._loop.call_later(_PATIENCE_S, partial(self._on_identify_timeout, foreign, intrusion))

    def _identify(self, foreign: ForeignConnection, intrusion: _Intrusion) -> None:
        if self._intrusions.get(foreign) is not intrusion:
            return
        topic = self._expected.topics[foreign.connection.topic]
        names = [name for name in topic.publishers if "*" not in name]
        source = foreign.connection.source
        work = partial(identify_peer, self._master, topic.topic, source, names)
        self._query_threads.submit(work, partial(self._on_identified, foreign, intrusion))

    def _on_identify_timeout(self, foreign: ForeignConnection, intrusion: _Intrusion) -> None:
        """Raise the alarm although the master has not said who it is, unless it may be old."""
        if self._intrusions.get(foreign) is not intrusion or intrusion.identity or intrusion.alarm:
            return
        if self._is_excused(foreign, intrusion):
            self._loop.call_later(
                _PATIENCE_S, partial(self._on_identify_timeout, foreign, intrusion)
            )
        else:
            self._raise_alarm(foreign, intrusion, PeerIdentity())

    def _on_identified(
        self, foreign: ForeignConnection, intrusion: _Intrusion, identity: PeerIdentity
    ) -> None:
        if self._intrusions.get(foreign) is not intrusion:
            return
        intrusion.identity = identity
        if self._is_planned(foreign, identity.name):
            self.learn_publisher(identity.name, foreign.connection.source)
        elif identity.is_refused and self._is_excused(foreign, intrusion):
            self._loop.call_later(_RETRY_S, partial(self._identify, foreign, intrusion))
        else:
            self._raise_alarm(foreign, intrusion, identity)

    def learn_publisher(self, name: str, uri: str) -> None:
        """Take a planned publisher's address from the master.

        If it had another one, where somebody still listens, there are two of that name.
        """
        before = self._addresses.address_of(name)
        if before in ("", uri):
            self._learn_address(name, uri)
        else:
            on_checked = partial(self._on_former_address_checked, name, uri)
            self._query_threads.submit(partial(refuses_connections, before), on_checked)

    def _on_former_address_checked(self, name: str, uri: str, is_refused: bool) -> None:  # noqa: FBT001 - an answer
        if is_refused:
            self._learn_address(name, uri)
            return
        for foreign, intrusion in list(self._intrusions.items()):
            if foreign.connection.source == uri:
                self._duplicate_uris = {*list(self._duplicate_uris)[:_MAX_DUPLICATES], uri}
                self._raise_alarm(foreign, intrusion, PeerIdentity(name=name, is_answered=True))

    def _learn_address(self, name: str, uri: str) -> None:
        self._addresses.learn(uri, name)
        self._duplicate_uris.discard(uri)
        self.update_all()

    def _is_planned(self, foreign: ForeignConnection, name: str) -> bool:
        topic = self._expected.topics[foreign.connection.topic]
        return bool(name) and name not in self._expected.guard_nodes and topic.may_publish(name)

    def _is_excused(self, foreign: ForeignConnection, intrusion: _Intrusion) -> bool:
        now = self._loop.now()
        was_first = now - self._started_at < _EXCUSED and self._was_in_first_response(foreign)
        was_publisher = (
            self._addresses.is_former(foreign.connection.source)
            and now - intrusion.since < _EXCUSED
        )
        return intrusion.alarm is None and (was_first or was_publisher)

    def _was_in_first_response(self, foreign: ForeignConnection) -> bool:
        """Tell whether the node had this connection when it was asked for the first time."""
        node = self._audited_nodes.by_name.get(foreign.node)
        return node is not None and foreign.connection in (node.first_connections or ())

    def _raise_alarm(
        self, foreign: ForeignConnection, intrusion: _Intrusion, identity: PeerIdentity
    ) -> None:
        source = foreign.connection.source
        if not identity.name:
            identity = replace(identity, name=self._takeover_uris.get(source, ""))
        duplicates = {identity.name} if source in self._duplicate_uris else set()
        alarm = foreign_connection_alarm(foreign, identity, self._expected.guard_nodes | duplicates)
        before, intrusion.alarm = intrusion.alarm, alarm
        if alarm != before:
            self._response.raise_(alarm, self._loop.now(), foreign.guarded)
        if before and alarm != before:
            self._response.withdraw(before)
        if self._response.stops_streams and source not in self._addresses.guard_addresses:
            topic = foreign.connection.topic
            self._response.listen(ListenToPublisher(foreign.guarded, topic, source))
        if self._response.stops_streams and identity.is_answered:
            self._disconnect(foreign, intrusion)
        if not intrusion.is_retry_scheduled:
            intrusion.is_retry_scheduled = True
            self._loop.call_later(
                _DISCONNECT_PERIOD_S, partial(self._identify_again, foreign, intrusion)
            )

    def _identify_again(self, foreign: ForeignConnection, intrusion: _Intrusion) -> None:
        """Ask again who it is: it may have registered since, or the master answer by now."""
        intrusion.is_retry_scheduled = False
        self._identify(foreign, intrusion)

    def _disconnect(self, foreign: ForeignConnection, intrusion: _Intrusion) -> None:
        """Try to end the connection: roscpp obeys the first call, an honest intruder the second."""
        node = self._audited_nodes.by_name.get(foreign.node)
        if (
            self._intrusions.get(foreign) is not intrusion
            or node is None
            or node.poll_target.server is None
        ):
            return
        topic = foreign.connection.topic
        self._send_publishers(node, topic)
        if not self._is_spared(foreign, intrusion, node):
            why = f"the plan lets nobody but the guard publish {topic}"
            end = partial(send_call, foreign.connection.source, "shutdown", why)
            self._call_threads.submit(end, lambda _: None)

    def _send_publishers(self, node: AuditedNode, topic: str) -> None:
        """Tell a node, in the master's place, whom it may hear."""
        if node.poll_target.server and (node.name, topic) not in self._unanswered_calls:
            sources = self._allowed_sources(node, topic)
            update = partial(
                send_call, node.poll_target.server.uri, "publisherUpdate", topic, sources
            )
            if self._call_threads.submit(update, partial(self._on_answered, node.name, topic)):
                self._unanswered_calls.add((node.name, topic))

    def _on_answered(self, name: str, topic: str, _answer: object) -> None:
        self._unanswered_calls.discard((name, topic))

    def _stream_of(self, topic: str) -> str:
        planned = self._expected.topics.get(topic)
        return planned.stream_topic if planned else ""

    def _allowed_sources(self, node: AuditedNode, topic: str) -> list[str]:
        """Return the addresses from which a node may hear a topic.

        A planned publisher need not be connected: an intruder may have sent the node away.
        """
        planned = self._expected.topics[topic]
        guard_uris = [
            uri for name, uri in self._guard.node_uris().items() if planned.may_publish(name)
        ]
        connected = planned_sources(planned, node.connections, self.addresses)
        others = sorted(connected | self.addresses.publishers_of(planned))
        return [*guard_uris, *(f"{uri}/" for uri in others if f"{uri}/" not in guard_uris)]

    def _is_spared(
        self, foreign: ForeignConnection, intrusion: _Intrusion, node: AuditedNode
    ) -> bool:
        """Tell whether the intruder is a node of the app, which may have other work to do."""
        name = intrusion.identity.name if intrusion.identity else ""
        named = {n for t in self._expected.topics.values() for n in (*t.publishers, *t.subscribers)}
        app = tuple(sorted(named - self._expected.guard_nodes - {"*"}))
        node_uri = node.poll_target.server is not None and node.poll_target.server.uri.rstrip("/")
        is_guard_address = foreign.connection.source in self.addresses.guard_addresses
        return (
            is_guard_address
            or foreign.connection.source == node_uri
            or bool(name and matches_any(app, name))
        )
