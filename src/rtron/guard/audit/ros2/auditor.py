"""The guard's continuous audit in ROS 2: who is in its way, told at each change of the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.audit.common.alarm_response import Response
from rtron.guard.audit.common.braking_alarms import Cases
from rtron.guard.audit.common.debounced_alarms import Standing
from rtron.guard.audit.ros2.expected_graph import Wanted, is_service
from rtron.guard.audit.ros2.graph_alarms import doubles, drifts, strangers
from rtron.guard.audit.ros2.graph_reader import Reader
from rtron.guard.audit.ros2.observed_graph import EVERYBODY, Seen
from rtron.guard.audit.ros2.supervisor_participants import Kin
from rtron.guard.transport.ros2.participants import Lives
from rtron.vocabulary import GUARD_NODE, SECOND, Plan

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.audit.ros2.endpoint_checks import Participants
    from rtron.guard.core.coordinator import Host
    from rtron.guard.core.event_loop import Loop
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.wire.ros2.endpoints import Ros2Endpoint

_DRIFT_PATIENCE = 3 * SECOND


class Ros2Auditor:
    """Audits the plan's enforced streams; does nothing for a plan without one.

    The graph calls at each change and twice a second besides, since some things only time tells.
    """

    def __init__(
        self,
        plan: Plan,
        host: Host,
        transport: Ros2Transport,
        loop: Loop,
        *,
        dry_run: bool = False,
    ) -> None:
        self._loop = loop
        self._transport = transport
        self._graph = transport.graph
        self._wanted = Wanted(plan)
        self._response = Response(host, transport, plan.audit.on_foreign, dry_run=dry_run)
        self._lives = Lives(self._graph.participant, transport.processes)
        self._kin = Kin(self._lives, transport.processes)
        self._cases = Cases(self._response)
        self._drifted = Standing(self._response, _DRIFT_PATIENCE)
        self._reader: Reader | None = None
        self._listeners: dict[bytes, str] | None = None

    def start(self) -> None:
        """Audit from now on, if anything is enforced."""
        if not self._wanted.topics:
            return
        self._response.prepare(self._transport.encoding)
        self._reader = Reader(self._transport.session.node(GUARD_NODE))
        for topic in (*self._wanted.topics, EVERYBODY):
            if not is_service(topic):
                self._graph.watch(topic)
        self._graph.changed.append(self._look)

    def close(self) -> None:
        """Audit no more."""
        if self._look in self._graph.changed:
            self._graph.changed.remove(self._look)

    def _look(self) -> None:
        now, seen = self._loop.now(), Seen(self._ends())
        self._lives.look((end.participant for end in seen.ends), now)
        ours = self._ours(seen)
        wanted, lives = self._wanted, self._lives
        past = strangers(wanted, seen, ours, lives, now)
        self._cases.found([*past, *doubles(wanted, seen, lives, now)], now)
        self._drifted.found(drifts(wanted, seen, ours), now)
        self._tell_new(seen)

    def _ends(self) -> Iterator[Ros2Endpoint]:
        """Yield everybody's endpoints, and our own where we have to be heard."""
        for topic in (*self._wanted.topics, EVERYBODY):
            if not is_service(topic):
                ends = self._graph.ends(topic)
                yield from ends.publishers
                yield from ends.subscribers
        if self._reader:
            served = (topic for topic in self._wanted.topics if is_service(topic))
            yield from self._reader.ends(served)
            outputs = [each for each in self._wanted.outputs.values() if not is_service(each)]
            ends_there = self._reader.ends(outputs)
            yield from (end for end in ends_there if self._graph.is_own(end.gid))

    def _ours(self, seen: Seen) -> Participants:
        """Return our participant and the supervisors'."""
        return self._kin.found(seen) | {self._graph.participant}

    def _tell_new(self, seen: Seen) -> None:
        """Tell a stop that has just been said to who begins to listen after it."""
        found = {
            end.gid: self._wanted.topics[private].guarded
            for private in self._wanted.outputs.values()
            for end in seen.subscribers(private)
            if self._wanted.topics[private].may_subscribe(end.node)
        }
        before, self._listeners = self._listeners, found
        for gid in found.keys() - (found if before is None else before).keys():
            self._response.listened(found[gid])
