"""The middleware of a guard: its transport, its nodes in the graph, and the audit of the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.audit.ros1.auditor import Ros1Auditor
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph, PlannedListeners
from rtron.guard.audit.ros1.guard_nodes import GuardNodes
from rtron.guard.audit.ros1.intruder_links import IntruderLinks
from rtron.guard.cell.access import WATCH
from rtron.guard.lanes.exchange.audit_exchange import NodesReport
from rtron.guard.transport.factory import open_ros1_transport, open_ros2_transport
from rtron.vocabulary import Mode, build_streams, normalise_type

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.audit.common.alarm_response import AlarmResponse
    from rtron.guard.audit.common.audit_response import AuditResponse
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.lanes.bulk.command_nodes import CommandNodes
    from rtron.guard.runner import Part
    from rtron.guard.transport.ros1.middleware import Ros1Transport
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.vocabulary import Plan
    from rtron.wire.ros2.session import Ros2Session

    OnListener = Callable[[str, str], None]


class Ros1Middleware:
    """The place of one process of the guard in a ROS 1 graph."""

    def __init__(self, plan: Plan, transport: Ros1Transport, loop: EventLoop) -> None:
        self.transport = transport
        self._plan, self._loop = plan, loop
        self._listeners = PlannedListeners(ExpectedGraph(plan))

    def report_nodes(self) -> NodesReport:
        """Return its nodes, for the audit in another process."""
        transport = self.transport
        return NodesReport(
            uris=transport.node_uris(),
            port=transport.port,
            subscribers=self._listeners.select(transport.all_subscribers()),
        )

    def register_node(self, name: str) -> None:
        """Take a name back that somebody else has taken."""
        self.transport.register_node(name)

    def set_listener_handlers(self, on_new: OnListener, on_lost: OnListener) -> None:
        """Call these with each planned node that has connected, or is connected no more."""
        self.transport.on_subscriber = self._for_planned(on_new)
        self.transport.on_subscriber_lost = self._for_planned(on_lost)

    def create_listener(self, response: AlarmResponse) -> Part:
        """Return what listens to intruders for a response in this process: it connects to them."""
        response.listener = links = IntruderLinks(self._loop, self.transport.master, response)
        return links

    def create_auditor(self, response: AuditResponse, commands: CommandNodes) -> Part:
        """Return an audit that asks the nodes and the master."""
        nodes = GuardNodes(self.transport, commands)
        auditor = Ros1Auditor(self._plan, self.transport.master, nodes, response, self._loop)
        commands.on_change = auditor.look_again
        return auditor

    def _for_planned(self, handler: OnListener) -> OnListener:
        """Return a handler that leaves strangers out: they may come and go at any rate."""

        def handle(topic: str, node: str) -> None:
            if self._listeners.includes(node):
                handler(topic, node)

        return handle


class Ros2Middleware:
    """The same in a domain; whoever has joined it sees who listens, and names are shared."""

    def __init__(self, plan: Plan, transport: Ros2Transport, loop: EventLoop) -> None:
        self.transport = transport
        self._plan, self._loop = plan, loop

    def report_nodes(self) -> NodesReport:
        """Return its nodes: the participant, and those of the guards before."""
        graph = self.transport.graph
        return NodesReport(participant=graph.participant, former_participants=graph.ended)

    def register_node(self, name: str) -> None:
        """Do nothing: nobody can take a name away."""

    def set_listener_handlers(self, on_new: OnListener, on_lost: OnListener) -> None:
        """Do nothing: the audit sees it in the graph."""

    def create_listener(self, response: AlarmResponse) -> Part:
        """Return what listens to intruders for a response in this process: it reads the outputs."""
        from rtron.guard.audit.ros2.intruder_readers import IntruderReaders  # noqa: PLC0415

        enforced = [each for each in build_streams(self._plan) if each.mode is Mode.ENFORCE]
        cells = self._plan.cell  # what leads there alone, nobody outside can say
        read = [each for each in enforced if not set(each.successors) <= set(cells)]
        types = {each.topic: normalise_type(each.type) for each in read}
        response.listener = readers = IntruderReaders(self.transport, types, response)
        return readers

    def create_auditor(self, response: AuditResponse, commands: CommandNodes) -> Part:
        """Return an audit that looks at the graph."""
        from rtron.guard.audit.ros2.auditor import Ros2Auditor  # noqa: PLC0415 - it needs rclpy

        auditor = Ros2Auditor(self._plan, self.transport, response, self._loop, commands)
        commands.on_change = auditor.look_again
        return auditor


Middleware = Ros1Middleware | Ros2Middleware


def open_middleware(
    plan: Plan,
    address: str,
    loop: EventLoop,
    session: Ros2Session | None = None,
    role: bytes = WATCH,
) -> Middleware:
    """Return the middleware of a plan, at a master or in a domain; see `open_transport`.

    `session` is in the domain already. `role` is that of `open_ros1_transport`.
    """
    if plan.ros == 1:
        return Ros1Middleware(plan, open_ros1_transport(plan, address, loop, role), loop)
    transport = open_ros2_transport(address, loop, session, plan=plan, role=role)
    return Ros2Middleware(plan, transport, loop)
