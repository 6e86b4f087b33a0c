"""The guard's continuous audit: whether it is really in the way (design section 4).

Each guarded node is asked who speaks to it, at the plan's period. The master's list adds what its
nodes do not tell; where the two differ, the nodes count.
"""

from collections.abc import Iterator
from functools import partial

from rtron.errors import WireError
from rtron.guard.audit.common.audit_response import AuditResponse
from rtron.guard.audit.common.debounced_alarms import DebouncedAlarms
from rtron.guard.audit.ros1.audited_nodes import AuditedNode, AuditedNodes
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.foreign_connections import normalise_uri, planned_sources
from rtron.guard.audit.ros1.guard_names import GuardNames
from rtron.guard.audit.ros1.guard_nodes import GuardNodes
from rtron.guard.audit.ros1.intrusions import Intrusions
from rtron.guard.audit.ros1.master_queries import WorkerThreads, look_up_uri, resolve_uri
from rtron.guard.audit.ros1.poll_schedule import PollSchedule, PollTarget
from rtron.guard.audit.ros1.registrations import (
    MasterRegistrations,
    drift_alarms,
    foreign_publisher_alarms,
    guarded_subscribers,
    select_registrations,
)
from rtron.guard.audit.ros1.xmlrpc_poller import ServerAddress, XmlRpcPoller, encode_call
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.node_shutdown import ShutdownRefusal
from rtron.vocabulary import GUARD_NODE, SECOND, Alarm, AlarmKind, Plan
from rtron.wire.ros1.ros_api import parse_system_state
from rtron.wire.ros1.xmlrpc import decode_ros_reply

_STATE = encode_call("getSystemState", GUARD_NODE)
_MAX_STATE_BYTES = 1 << 22
_STATE_PERIOD = SECOND // 2
_TICK_S = 0.5
_TICKS_PER_NAME_CHECK = 10
_DRIFT_DELAY = 3 * SECOND
_UNSEEN_DELAY = 3 * SECOND
_MASTER_DELAY = 5 * SECOND
"""How long a master may be silent before that is an alarm, ns: one that restarts is back sooner."""
_MASTER_SILENT = "the master does not answer: impostors and nodes that come are not found"
_UNKNOWN_NODES = "the command process has not told its nodes"
_WAY_OUT = "end it or start it again; if its machine is gone, `rosnode cleanup`"


class Ros1Auditor:
    """Audits the plan's enforced streams on the loop; does nothing for a plan without one."""

    def __init__(
        self,
        plan: Plan,
        master: str,
        guard: GuardNodes,
        response: AuditResponse,
        loop: EventLoop,
    ) -> None:
        self._loop = loop
        self._guard = guard
        self._response = response
        self._master = master
        self._expected = ExpectedGraph(plan)
        self._state: MasterRegistrations | None = None
        self._state_body = b""
        self._is_state_current = False
        """Whether the master has told its state since the guard's nodes are known."""
        self._master_answered_at = loop.now()
        self._tick_count = 0
        self._first_reasons: dict[str, str] = {}
        self._named_nodes = frozenset(n for n in self._expected.listener_patterns() if "*" not in n)
        self._schedule = PollSchedule(loop, plan.audit.period)
        self._audited_nodes = AuditedNodes(loop, master, self._expected, self._schedule)
        claimed: dict[str, str] = {}
        expected, nodes = self._expected, self._audited_nodes
        self._intrusions = Intrusions(loop, master, guard, expected, nodes, response, claimed)
        self._guard_names = GuardNames(loop, master, guard, expected, response, claimed)
        self._parser_threads = WorkerThreads(loop, "audit-state")
        self._lookup_threads = WorkerThreads(loop, "audit-meet")
        self._foreign_registrations = DebouncedAlarms(response, 0)
        self._drift_alarms = DebouncedAlarms(response, _DRIFT_DELAY)
        self._unseen_alarms = DebouncedAlarms(response, 0)
        self._audited_nodes.on_change = self._intrusions.update
        response.find_missing = self._find_missing
        response.find_unseen = self._find_unseen
        self._state_poll = PollTarget(
            poller=XmlRpcPoller(_STATE, _MAX_STATE_BYTES),
            on_response=self._on_state,
            on_failure=self._on_state_failure,
        )

    def open(self) -> None:
        """Audit from now on, if anything is enforced; refuse to shut our nodes down anyway."""
        if not self._expected.topics:
            self._guard.set_shutdown_handler(ShutdownRefusal(self._loop).handle)
            return
        self._guard.set_shutdown_handler(self._guard_names.handle_shutdown)
        self._guard.set_listener_handlers(self._on_new_listener, self._on_lost_listener)
        self._audited_nodes.watch(sorted(self._named_nodes))
        self._schedule.add(self._state_poll)
        self._schedule.start()
        self._resolve_master()
        self._tick()

    def close(self) -> None:
        """Audit no more."""
        self._guard.set_listener_handlers(self._on_new_listener, lambda topic, name: None)
        self._schedule.close()
        for part in (
            self._audited_nodes,
            self._intrusions,
            self._guard_names,
            self._parser_threads,
            self._lookup_threads,
        ):
            part.close()

    def look_again(self) -> None:
        """Look at everything again: the nodes of another process of ours are known, or others."""
        if self._expected.topics:
            self._is_state_current = False
            self._intrusions.update_all()
            self._guard_names.update()

    def _on_new_listener(self, topic: str, name: str) -> None:
        """Look for a node that has just begun to listen to us: it may have come, or come back."""
        planned = self._expected.topics.get(topic)
        if planned is None or not self._expected.audited_topics(name):
            return
        self._audited_nodes.watch([name])
        if name in self._audited_nodes.by_name:
            self._audited_nodes.resolve(self._audited_nodes.by_name[name])
        self._response.on_new_listener(planned.stream_topic)

    def _on_lost_listener(self, topic: str, name: str) -> None:
        """Be heard again by a node that an intruder may have sent away."""
        self._intrusions.keep_listener(name, topic)

    def _resolve_master(self) -> None:
        self._parser_threads.submit(partial(resolve_uri, self._master), self._on_master_resolved)

    def _on_master_resolved(self, server: ServerAddress | None) -> None:
        if server is not None:
            self._state_poll.server = server
        else:
            self._loop.call_later(1.0, self._resolve_master)

    def _on_state(self, body: bytes) -> None:
        self._master_answered_at = self._loop.now()
        self._state_poll.not_before = self._master_answered_at + _STATE_PERIOD
        if body == self._state_body:
            self._is_state_current = True
        else:
            work = partial(_parse_state, body, self._expected)
            self._parser_threads.submit(work, partial(self._on_state_parsed, body))

    def _on_state_failure(self, error: Exception) -> None:
        del error  # `_master_alarms` tells it, if it lasts
        self._state_poll.not_before = self._loop.now() + _STATE_PERIOD

    def _on_state_parsed(self, body: bytes, state: MasterRegistrations | None) -> None:
        if state is None:
            return
        self._state, self._state_body, self._is_state_current = state, body, True
        self._audited_nodes.watch(guarded_subscribers(state, self._expected))
        self._guard_names.check()
        self._learn_publishers(state)
        self._update_alarms(state)

    def _learn_publishers(self, state: MasterRegistrations) -> None:
        """Learn where the planned publishers live, before they are asked for."""
        for private in self._expected.outputs.values():
            for name in state.publishers.get(private, frozenset()) - self._expected.guard_nodes:
                if self._expected.topics[private].may_publish(name):
                    self._look_up_publisher(name)

    def _look_up_publisher(self, name: str) -> None:
        def met(uri: str) -> None:
            if uri:
                self._intrusions.learn_publisher(name, normalise_uri(uri))

        self._lookup_threads.submit(partial(look_up_uri, self._master, name), met)

    def _update_alarms(self, state: MasterRegistrations) -> None:
        now = self._loop.now()
        self._foreign_registrations.update(foreign_publisher_alarms(state, self._expected), now)
        disconnected = self._disconnected_alarms(state)
        self._drift_alarms.update([*drift_alarms(state, self._expected), *disconnected], now)

    def _tick(self) -> None:
        """Look at what time alone changes."""
        self._loop.call_later(_TICK_S, self._tick)
        self._tick_count += 1
        is_urgent = self._guard_names.has_takeover or not self._guard_names.is_checked
        if is_urgent or self._tick_count % _TICKS_PER_NAME_CHECK == 0:
            self._guard_names.check()
        if self._state is not None:
            self._update_alarms(self._state)
        for node in list(self._audited_nodes.by_name.values()):
            self._maintain_node(node)
        alarms = [*self._master_alarms(), *self._unseen_node_alarms()]
        self._unseen_alarms.update(alarms, self._loop.now())

    def _maintain_node(self, node: AuditedNode) -> None:
        """Find a node that does not answer; forget one that has gone and that no plan names."""
        is_absent = node.is_refused or node.poll_target.server is None
        if is_absent and node.name not in self._named_nodes and not self._is_present(node):
            self._audited_nodes.forget(node)
        elif node.failure:
            self._audited_nodes.resolve(node)

    def _is_present(self, node: AuditedNode) -> bool:
        """Tell whether the master or our own connections know of a node that listens."""
        listed = self._state is not None and node.name in guarded_subscribers(
            self._state, self._expected
        )
        return listed or self._is_listening(node)

    def _is_listening(self, node: AuditedNode) -> bool:
        return any(node.name in self._guard.subscribers(topic) for topic in node.audited_topics)

    def _find_missing(self) -> str:
        """Return what was not looked at since the guard's nodes are known, "" if nothing."""
        return next(self._gaps(), "") if self._expected.topics else ""

    def _gaps(self) -> Iterator[str]:
        if self._guard.unknown_streams():
            yield _UNKNOWN_NODES
        if not self._is_state_current:
            yield "the master does not answer"
        if not self._guard_names.is_checked:
            yield "the master has not told who has the guard's names"
        for node in filter(self._is_unseen, self._audited_nodes.by_name.values()):
            yield f"{node.name} cannot be audited: {node.failure}"
        if source := self._intrusions.unidentified():
            yield f"it is not known yet who {source} is"
        if self._drift_alarms.has_pending:
            yield "alarms wait for their confirmation"

    def _is_unseen(self, node: AuditedNode) -> bool:
        """Tell whether a node is there and has not told who speaks to it."""
        return bool(node.failure) and self._is_there(node)

    def _is_there(self, node: AuditedNode) -> bool:
        has_gone = node.is_refused or not self._is_present(node)
        return self._is_listening(node) or not has_gone

    def _find_unseen(self, since: int) -> dict[str, str]:
        """Return the streams whose listeners have not all told since then who speaks to them.

        The master is needed once, to find them: from then on they know who speaks to them, and it
        does not.
        """
        if self._state is None:
            streams = {each.stream_topic for each in self._expected.topics.values()}
            return dict.fromkeys(streams, "the master has not answered")
        unseen = dict.fromkeys(self._guard.unknown_streams(), _UNKNOWN_NODES)
        for node in self._audited_nodes.by_name.values():
            if (node.failure or node.last_response_at <= since) and self._is_there(node):
                failure = f"{node.failure} ({_WAY_OUT})" if node.failure else "it is asked seldom"
                why = f"{node.name} cannot be audited: {failure}"
                unseen |= {each.stream_topic: why for each in node.audited_topics.values()}
        return unseen

    def _master_alarms(self) -> Iterator[Alarm]:
        """Yield an alarm if the master is silent: nodes that come are not found, nor impostors."""
        if self._loop.now() - self._master_answered_at > _MASTER_DELAY:
            yield Alarm(kind=AlarmKind.UNREACHABLE, reason=_MASTER_SILENT)

    def _unseen_node_alarms(self) -> Iterator[Alarm]:
        """Yield an alarm for each node that is there and does not say who speaks to it."""
        now = self._loop.now()
        late = [
            node
            for node in self._audited_nodes.by_name.values()
            if node.failure
            and now - node.last_response_at > _UNSEEN_DELAY
            and self._can_answer(node)
        ]
        # The first fault is told: another one, later, is no other alarm.
        former, self._first_reasons = self._first_reasons, {}
        for node in late:
            reason = former.get(node.name, f"{node.name} cannot be audited: {node.failure}")
            self._first_reasons[node.name] = reason
            yield Alarm(kind=AlarmKind.UNREACHABLE, reason=reason, node=node.name)

    def _can_answer(self, node: AuditedNode) -> bool:
        is_reachable = node.poll_target.server is not None and not node.is_refused
        return is_reachable or self._is_listening(node)

    def _disconnected_alarms(self, state: MasterRegistrations) -> Iterator[Alarm]:
        """Yield an alarm for each node that subscribes a private output and does not hear us."""
        addresses = self._intrusions.addresses
        for private in self._expected.outputs.values():
            planned = self._expected.topics[private]
            if not state.publishers.get(private, frozenset()) & self._expected.guard_nodes:
                continue
            for name in sorted(state.subscribers.get(private, ())):
                node = self._audited_nodes.by_name.get(name)
                if (
                    node
                    and not node.failure
                    and not planned_sources(planned, node.connections, addresses)
                ):
                    reason = f"{name} subscribes {private} and is not connected to the guard"
                    yield Alarm(kind=AlarmKind.DRIFT, reason=reason, topic=private, node=name)


def _parse_state(body: bytes, expected: ExpectedGraph) -> MasterRegistrations | None:
    try:
        return select_registrations(parse_system_state(decode_ros_reply(body)), expected.topics)
    except WireError:
        return None
