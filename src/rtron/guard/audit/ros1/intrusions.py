"""Strangers at guarded nodes: found out about, told, and driven out where the plan says so."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

from rtron.guard.audit.common.alarm_response import Response
from rtron.guard.audit.ros1.audited_node import GuardedNode
from rtron.guard.audit.ros1.audited_nodes import GuardedNodes
from rtron.guard.audit.ros1.expected_graph import Expectations, meant
from rtron.guard.audit.ros1.foreign_connections import (
    Identity,
    Stranger,
    alarm_of,
    planned_sources,
    strangers_of,
)
from rtron.guard.audit.ros1.master_queries import Threads, identify, refuses, tell
from rtron.guard.audit.ros1.node_addresses import Addresses
from rtron.guard.core.event_loop import Loop
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import SECOND, Alarm

_PATIENCE_S = 0.03
"""How long an alarm waits for the master to say who it is."""
_EXCUSED = 5 * SECOND
"""How long a dead guard's or supervisor's address may still stand in a subscriber's list."""
_AGAIN_S = 0.2
_REVOKE_S = 1.0
_MOST_DOUBLED = 64
_MOST_AT_A_NODE = 16
"""How many strangers at one node are dealt with at a time; the others when these are gone."""


@dataclass(slots=True, eq=False)
class _Case:
    since: int
    identity: Identity | None = None
    alarm: Alarm | None = None
    waits: bool = False


class Intruders:
    """Keeps a case for each stranger, from when a node's answer shows it until it does no more.

    A subscriber may keep the address of a guard or supervisor that is dead, until the master tells
    it of the next one. So an address where nobody listens is looked at again, for 5 s at most,
    when the guard has just begun and the node's first answer had it, or when it was a planned
    publisher's. Nothing else is excused.
    """

    def __init__(
        self,
        loop: Loop,
        master: str,
        transport: Ros1Transport,
        expected: Expectations,
        nodes: GuardedNodes,
        response: Response,
        claimed: Mapping[str, str],
    ) -> None:
        """`claimed` are the addresses of nodes that had one of the guard's names, and which."""
        self._loop = loop
        self._master = master
        self._transport = transport
        self._expected = expected
        self._nodes = nodes
        self._response = response
        self._claimed = claimed
        self._addresses = Addresses({})
        self._cases: dict[Stranger, _Case] = {}
        self._doubled: set[str] = set()
        self._began = loop.now()
        self._askers = Threads(loop, "audit-ask", 2)
        self._tellers = Threads(loop, "audit-tell", 2)

    @property
    def addresses(self) -> Addresses:
        """Whose an address is; the guard's own are what they are at this moment."""
        self._addresses.own = {
            uri.rstrip("/"): node for node, uri in self._transport.addresses().items()
        }
        self._addresses.port = self._transport.port
        return self._addresses

    def look(self, node: GuardedNode) -> None:
        """Look at whom a node hears; what it hears no more is settled."""
        found = strangers_of(node.name, node.links, node.heard, self.addresses)
        gone, stay = node.strangers - found, node.strangers & found
        come = list(islice(found - stay, _MOST_AT_A_NODE - len(stay)))
        node.strangers = stay.union(come)
        for stranger in gone:
            self._leave(stranger)
        for stranger in come:
            self._suspect(stranger)

    def close(self) -> None:
        """Begin nothing any more."""
        self._askers.close()
        self._tellers.close()

    def _leave(self, stranger: Stranger) -> None:
        case = self._cases.pop(stranger, None)
        if case and case.alarm:
            self._response.settle(case.alarm)

    def _suspect(self, stranger: Stranger) -> None:
        case = self._cases[stranger] = _Case(self._loop.now())
        self._ask(stranger, case)
        self._loop.call_later(_PATIENCE_S, partial(self._impatient, stranger, case))

    def _ask(self, stranger: Stranger, case: _Case) -> None:
        if self._cases.get(stranger) is not case:
            return
        topic = self._expected.topics[stranger.link.topic]
        names = [name for name in topic.publishers if "*" not in name]
        source = stranger.link.source
        work = partial(identify, self._master, topic.topic, source, names)
        self._askers.submit(work, partial(self._identified, stranger, case))

    def _impatient(self, stranger: Stranger, case: _Case) -> None:
        """Raise the alarm although the master has not said who it is, unless it may be old."""
        if self._cases.get(stranger) is not case or case.identity or case.alarm:
            return
        if self._excused(stranger, case):
            self._loop.call_later(_PATIENCE_S, partial(self._impatient, stranger, case))
        else:
            self._tell(stranger, case, Identity())

    def _identified(self, stranger: Stranger, case: _Case, identity: Identity) -> None:
        if self._cases.get(stranger) is not case:
            return
        case.identity = identity
        if self._is_planned(stranger, identity.name):
            self.meet(identity.name, stranger.link.source)
        elif identity.refused and self._excused(stranger, case):
            self._loop.call_later(_AGAIN_S, partial(self._ask, stranger, case))
        else:
            self._tell(stranger, case, identity)

    def meet(self, name: str, uri: str) -> None:
        """Take a planned publisher's address from the master.

        If it had another one, where somebody still listens, there are two of that name.
        """
        before = self._addresses.of(name)
        if before in ("", uri):
            self._learn(name, uri)
        else:
            met = partial(self._met, name, uri)
            self._askers.submit(partial(refuses, before), met)

    def _met(self, name: str, uri: str, refused: bool) -> None:  # noqa: FBT001 - an answer
        if refused:
            self._learn(name, uri)
            return
        for stranger, case in list(self._cases.items()):
            if stranger.link.source == uri:
                self._doubled = {*list(self._doubled)[:_MOST_DOUBLED], uri}
                self._tell(stranger, case, Identity(name=name, answered=True))

    def _learn(self, name: str, uri: str) -> None:
        self._addresses.learn(uri, name)
        self._doubled.discard(uri)
        for node in list(self._nodes.by_name.values()):
            self.look(node)

    def _is_planned(self, stranger: Stranger, name: str) -> bool:
        topic = self._expected.topics[stranger.link.topic]
        return bool(name) and name not in self._expected.own and topic.may_publish(name)

    def _excused(self, stranger: Stranger, case: _Case) -> bool:
        now = self._loop.now()
        begins = now - self._began < _EXCUSED and self._was_there(stranger)
        was = self._addresses.was(stranger.link.source) and now - case.since < _EXCUSED
        return case.alarm is None and (begins or was)

    def _was_there(self, stranger: Stranger) -> bool:
        """Tell whether the node had this connection when it was asked for the first time."""
        node = self._nodes.by_name.get(stranger.node)
        return node is not None and stranger.link in (node.first or ())

    def _tell(self, stranger: Stranger, case: _Case, identity: Identity) -> None:
        source = stranger.link.source
        if not identity.name:
            identity = replace(identity, name=self._claimed.get(source, ""))
        doubled = {identity.name} if source in self._doubled else set()
        alarm = alarm_of(stranger, identity, self._expected.own | doubled)
        before, case.alarm = case.alarm, alarm
        if alarm != before:
            self._response.raise_(alarm, self._loop.now(), stranger.guarded)
        if before and alarm != before:
            self._response.settle(before)
        if self._response.stops and identity.answered:
            self._revoke(stranger, case)
        if not case.waits:
            case.waits = True
            self._loop.call_later(_REVOKE_S, partial(self._ask_again, stranger, case))

    def _ask_again(self, stranger: Stranger, case: _Case) -> None:
        """Ask again who it is: it may have registered since, or the master answer by now."""
        case.waits = False
        self._ask(stranger, case)

    def _revoke(self, stranger: Stranger, case: _Case) -> None:
        """Try to end the connection: roscpp obeys the first call, an honest intruder the second."""
        node = self._nodes.by_name.get(stranger.node)
        if self._cases.get(stranger) is not case or node is None or node.asked.place is None:
            return
        topic = stranger.link.topic
        update = (node.asked.place.uri, "publisherUpdate", topic, self._rightful(node, topic))
        self._tellers.submit(partial(tell, *update), lambda _: None)
        if not self._spared(stranger, case, node):
            why = f"the plan lets nobody but the guard publish {topic}"
            end = partial(tell, stranger.link.source, "shutdown", why)
            self._tellers.submit(end, lambda _: None)

    def _rightful(self, node: GuardedNode, topic: str) -> list[str]:
        """Return the addresses from which a node may hear a topic."""
        planned = self._expected.topics[topic]
        own = [
            uri for name, uri in self._transport.addresses().items() if planned.may_publish(name)
        ]
        heard = planned_sources(planned, node.links, self.addresses)
        return [*own, *(f"{uri}/" for uri in heard if f"{uri}/" not in own)]

    def _spared(self, stranger: Stranger, case: _Case, node: GuardedNode) -> bool:
        """Tell whether the intruder is a node of the app, which may have other work to do."""
        name = case.identity.name if case.identity else ""
        named = {n for t in self._expected.topics.values() for n in (*t.publishers, *t.subscribers)}
        app = tuple(sorted(named - self._expected.own - {"*"}))
        own = node.asked.place is not None and node.asked.place.uri.rstrip("/")
        ours = stranger.link.source in self.addresses.own
        return ours or stranger.link.source == own or bool(name and meant(app, name))
