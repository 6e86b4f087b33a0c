"""The guard's continuous audit: whether it is really in the way (design section 4).

Each guarded node is asked who speaks to it, at the plan's period. The master's list adds what its
nodes do not tell; where the two differ, the nodes count.
"""

from collections.abc import Callable, Iterator
from functools import partial

from rtron.errors import WireError
from rtron.guard.audit.common.alarm_response import Response
from rtron.guard.audit.common.debounced_alarms import Standing
from rtron.guard.audit.ros1.audited_node import GuardedNode
from rtron.guard.audit.ros1.audited_nodes import GuardedNodes
from rtron.guard.audit.ros1.bus_info import plain, value_of
from rtron.guard.audit.ros1.expected_graph import Expectations
from rtron.guard.audit.ros1.foreign_connections import planned_sources
from rtron.guard.audit.ros1.guard_names import OwnNames
from rtron.guard.audit.ros1.intrusions import Intruders
from rtron.guard.audit.ros1.master_queries import Threads, place_at, uri_of
from rtron.guard.audit.ros1.poll_schedule import Asked, Rounds
from rtron.guard.audit.ros1.registrations import Registered, drift, foreign, listeners, registered
from rtron.guard.audit.ros1.xmlrpc_poller import Asker, Place, request
from rtron.guard.core.coordinator import Host
from rtron.guard.core.event_loop import Loop
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import GUARD_NODE, SECOND, Alarm, AlarmKind, Plan

_STATE = request("getSystemState", GUARD_NODE)
_MOST_STATE = 1 << 22
_STATE_EVERY = SECOND // 2
_LOOK_S = 0.5
_NAMES_EVERY = 10
_DRIFT_PATIENCE = 3 * SECOND
_UNSEEN = 3 * SECOND


class Auditor:
    """Audits the plan's enforced streams on the loop; does nothing for a plan without one."""

    def __init__(
        self,
        plan: Plan,
        master: str,
        host: Host,
        transport: Ros1Transport,
        loop: Loop,
        *,
        dry_run: bool = False,
    ) -> None:
        self._loop = loop
        self._transport = transport
        self._master = master
        self._expected = Expectations(plan)
        self._state: Registered | None = None
        self._state_body = b""
        self._looks = 0
        self._told: dict[str, str] = {}
        self._named = frozenset(n for n in self._expected.listeners() if "*" not in n)
        on_foreign = plan.audit.on_foreign
        response = self._response = Response(host, transport, on_foreign, dry_run=dry_run)
        self._rounds = Rounds(loop, plan.audit.period)
        self._nodes = GuardedNodes(loop, master, self._expected, self._rounds)
        claimed: dict[str, str] = {}
        expected, nodes = self._expected, self._nodes
        self._intruders = Intruders(loop, master, transport, expected, nodes, response, claimed)
        self._names = OwnNames(loop, master, transport, expected, response, claimed)
        self._readers = Threads(loop, "audit-state")
        self._askers = Threads(loop, "audit-meet")
        self._registered_wrongly = Standing(response, 0)
        self._drifted = Standing(response, _DRIFT_PATIENCE)
        self._unseen = Standing(response, 0)
        self._nodes.heard = self._intruders.look
        self._asked = Asked(
            asker=Asker(_STATE, _MOST_STATE), answered=self._answered, failed=self._failed
        )

    def start(self) -> None:
        """Audit from now on, if anything is enforced."""
        if not self._expected.topics:
            return
        self._response.prepare(self._transport.encoding)
        self._transport.listened = self._listened
        self._nodes.watch(sorted(self._named))
        self._rounds.add(self._asked)
        self._rounds.start()
        self._find_master()
        self._look()

    def shut(self, node: str, reason: str, obey: Callable[[], None]) -> None:
        """Decide whether a call to shut one of our nodes down is obeyed: not if it was replaced."""
        if self._expected.topics:
            self._names.shut(node, reason, obey)
        else:
            obey()

    def close(self) -> None:
        """Audit no more."""
        self._rounds.close()
        for part in (self._nodes, self._intruders, self._names, self._readers, self._askers):
            part.close()

    def _listened(self, topic: str, name: str) -> None:
        """Look for a node that has just begun to listen to us: it may have come, or come back."""
        planned = self._expected.topics.get(topic)
        if planned is None or not self._expected.heard(name):
            return
        self._nodes.watch([name])
        if name in self._nodes.by_name:
            self._nodes.find(self._nodes.by_name[name])
        self._response.listened(planned.guarded)

    def _find_master(self) -> None:
        self._readers.submit(partial(place_at, self._master), self._found_master)

    def _found_master(self, place: Place | None) -> None:
        if place is not None:
            self._asked.place = place
        else:
            self._loop.call_later(1.0, self._find_master)

    def _answered(self, body: bytes) -> None:
        self._asked.not_before = self._loop.now() + _STATE_EVERY
        if body != self._state_body:
            work = partial(_registered, body, self._expected)
            self._readers.submit(work, partial(self._read, body))

    def _failed(self, error: Exception) -> None:
        del error  # the guard's registrar tells that the master does not answer
        self._asked.not_before = self._loop.now() + _STATE_EVERY

    def _read(self, body: bytes, state: Registered | None) -> None:
        if state is None:
            return
        self._state, self._state_body = state, body
        self._nodes.watch(listeners(state, self._expected))
        self._names.check()
        self._meet(state)
        self._judge(state)

    def _meet(self, state: Registered) -> None:
        """Learn where the planned publishers live, before they are asked for."""
        for private in self._expected.outputs.values():
            for name in state.publishers.get(private, frozenset()) - self._expected.own:
                if self._expected.topics[private].may_publish(name):
                    self._met(name)

    def _met(self, name: str) -> None:
        def met(uri: str) -> None:
            if uri:
                self._intruders.meet(name, plain(uri))

        self._askers.submit(partial(uri_of, self._master, name), met)

    def _judge(self, state: Registered) -> None:
        now = self._loop.now()
        self._registered_wrongly.found(foreign(state, self._expected), now)
        unheard = self._unheard(state)
        self._drifted.found([*drift(state, self._expected), *unheard], now)

    def _look(self) -> None:
        """Look at what time alone changes."""
        self._loop.call_later(_LOOK_S, self._look)
        self._looks += 1
        if self._names.taken or self._looks % _NAMES_EVERY == 0:
            self._names.check()
        if self._state is not None:
            self._judge(self._state)
        for node in list(self._nodes.by_name.values()):
            self._look_after(node)
        self._unseen.found(self._silent(), self._loop.now())

    def _look_after(self, node: GuardedNode) -> None:
        """Find a node that does not answer; forget one that has gone and that no plan names."""
        gone = node.refused or node.asked.place is None
        if gone and node.name not in self._named and not self._is_there(node):
            self._nodes.forget(node)
        elif node.fault:
            self._nodes.find(node)

    def _is_there(self, node: GuardedNode) -> bool:
        """Tell whether the master or our own connections know of a node that listens."""
        listed = self._state is not None and node.name in listeners(self._state, self._expected)
        return listed or self._listens(node)

    def _listens(self, node: GuardedNode) -> bool:
        return any(node.name in self._transport.listeners(topic) for topic in node.heard)

    def _silent(self) -> Iterator[Alarm]:
        """Yield an alarm for each node that is there and does not say who speaks to it."""
        now = self._loop.now()
        late = [
            node
            for node in self._nodes.by_name.values()
            if node.fault and now - node.seen > _UNSEEN and self._could_answer(node)
        ]
        # The first fault is told: another one, later, is no other alarm.
        told, self._told = self._told, {}
        for node in late:
            reason = told.get(node.name, f"{node.name} cannot be audited: {node.fault}")
            self._told[node.name] = reason
            yield Alarm(kind=AlarmKind.UNSEEN, reason=reason, node=node.name)

    def _could_answer(self, node: GuardedNode) -> bool:
        reachable = node.asked.place is not None and not node.refused
        return reachable or self._listens(node)

    def _unheard(self, state: Registered) -> Iterator[Alarm]:
        """Yield an alarm for each node that subscribes a private output and does not hear us."""
        known = self._intruders.addresses
        for private in self._expected.outputs.values():
            planned = self._expected.topics[private]
            if not state.publishers.get(private, frozenset()) & self._expected.own:
                continue
            for name in sorted(state.subscribers.get(private, ())):
                node = self._nodes.by_name.get(name)
                if node and not node.fault and not planned_sources(planned, node.links, known):
                    reason = f"{name} subscribes {private} and is not connected to the guard"
                    yield Alarm(kind=AlarmKind.DRIFT, reason=reason, topic=private, node=name)


def _registered(body: bytes, expected: Expectations) -> Registered | None:
    try:
        return registered(value_of(body), expected.topics)
    except WireError:
        return None
