"""A client's node in ROS 2: all are in one participant, and the guard tells them apart by node.

A participant does not hear itself, so what one client publishes is given to the others here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from rtron.bridge.common.guarded_output import GuardedOutput
from rtron.bridge.protocol.effects import ParameterVerb, RequestService
from rtron.bridge.ros2.goals import ClientGoals
from rtron.bridge.ros2.parameters import parameter_answer, parameter_call
from rtron.errors import RTronError, SourceError
from rtron.guard.core.printable import printable
from rtron.guard.transport.common.protocol import (
    InputOptions,
    MessageHandler,
    OutputOptions,
    Peer,
)
from rtron.messages import Encoding
from rtron.messages.common.json_decoder import decode_response
from rtron.messages.common.json_encoder import encode_json
from rtron.vocabulary import SECOND, QoS

if TYPE_CHECKING:
    from rtron.bridge.common.client_node import NodeListener
    from rtron.bridge.common.message_types import MessageTypes
    from rtron.bridge.protocol.effects import CancelGoal, RequestParameter, SendGoal
    from rtron.bridge.protocol.frames import Document
    from rtron.bridge.rights.document import ClientRights
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.guard.transport.ros2.service_endpoints import CalledService

_MAX_CALLED = 100
"""How many services one connection may call: each is an endpoint in the graph."""
_RETRY = SECOND // 20
"""How long a service that nobody offers yet is waited for at a time: discovery takes a moment."""
_FAREWELL = 2 * SECOND
"""How long a client that has left is in the graph for the answers to its goals' cancels, ns."""
_STEP_S = 0.05


@dataclass(frozen=True, slots=True)
class _SentRequest:
    """A call of the session that has its number, until `deadline` (ns)."""

    number: int
    deadline: int
    parameter: RequestParameter | None


class Ros2NodeFactory:
    """Opens the nodes of clients in one participant."""

    def __init__(self, loop: EventLoop, transport: Ros2Transport, types: MessageTypes) -> None:
        self.loop = loop
        self.transport = transport
        self.types = types
        self._nodes: list[Ros2ClientNode] = []
        transport.set_unreadable_handler(self._report_unreadable)

    def open(self, client: ClientRights, listener: NodeListener) -> Ros2ClientNode:
        """Return the node of a client."""
        node = Ros2ClientNode(self, client, listener)
        self._nodes.append(node)
        return node

    def remove(self, node: Ros2ClientNode) -> None:
        """Take a node that has left out of the graph, unless its client has come back."""
        self._nodes.remove(node)
        if all(each.name != node.name for each in self._nodes):
            self.transport.session.destroy_node(node.name)

    def pass_on(self, sender: Ros2ClientNode, topic: str, message: bytes) -> None:
        """Give a message of one client to the others that read its topic."""
        for node in list(self._nodes):
            if node is not sender:
                node.take(topic, message)

    def _report_unreadable(self, topic: str, node: str, why: str) -> None:
        """Tell those who read a topic that a publisher of it cannot be read."""
        for each in list(self._nodes):
            each.report(topic, f"{topic}: {printable(node)} {why}")

    def close(self) -> None:
        """Leave the domain, once the nodes have left."""
        while any(node.is_leaving for node in self._nodes):
            self.loop.step(_STEP_S)
        self.transport.close()


class Ros2ClientNode:
    """The topics and calls of one client; see `ClientNode`."""

    def __init__(
        self, factory: Ros2NodeFactory, client: ClientRights, listener: NodeListener
    ) -> None:
        self.name = client.node
        self.is_leaving = False
        self._factory = factory
        self._transport = factory.transport
        self._client = client
        self._listener = listener
        self._outputs: dict[str, GuardedOutput] = {}
        self._read: set[str] = set()
        self._called: dict[str, CalledService] = {}
        self._open_calls: dict[tuple[str, int], _SentRequest] = {}
        self._goals: dict[str, ClientGoals] = {}

    def advertise(self, topic: str, type: str, listeners: tuple[str, ...]) -> None:
        """Publish a topic from now on, which these nodes of the guard hear, if any."""
        depth = self._client.limits.queue
        output = self._transport.advertise(
            self._client.node, topic, type, OutputOptions(queue_size=depth, successors=listeners)
        )
        output.offer(self._client.node, QoS())
        self._outputs[topic] = GuardedOutput(
            self._factory.loop, output, topic, type, listeners, self._listener.on_problem
        )

    def withdraw(self, topic: str) -> None:
        """Publish a topic no more."""
        output = self._outputs.pop(topic, None)
        if output:
            output.close()
            self._transport.remove_publication(self._client.node, topic)

    def publish(self, topic: str, message: bytes, *, is_latched: bool) -> None:
        """Publish a message on a topic that is advertised."""
        output = self._outputs.get(topic)
        if output:
            output.publish(message, self._client.node if is_latched else None)
            self._factory.pass_on(self, topic, message)

    def read(self, topic: str, type: str) -> None:
        """Subscribe to a topic from now on."""

        def accept(peer: Peer) -> MessageHandler:
            del peer
            return partial(self.take, topic)

        options = InputOptions(queue_size=self._client.limits.queue)
        self._transport.subscribe(self._client.node, topic, type, accept, options)
        self._read.add(topic)

    def leave(self, topic: str) -> None:
        """Subscribe to a topic no more."""
        if topic in self._read:
            self._read.discard(topic)
            self._transport.remove_subscription(self._client.node, topic)

    def take(self, topic: str, message: bytes) -> None:
        """Pass a message on, if its topic is read."""
        if topic in self._read:
            self._listener.on_message(topic, message)

    def report(self, topic: str, reason: str) -> None:
        """Pass on what is the matter with a topic, if it is read."""
        if topic in self._read:
            self._listener.on_problem(reason)

    def call(self, request: RequestService) -> None:
        """Call a service, as soon as somebody offers it."""
        try:
            self._begin_call(request, None)
        except RTronError as error:
            self._listener.on_answer(request.number, error)

    def access_parameter(self, request: RequestParameter) -> None:
        """Read or write a parameter of a node; the listener gets the answer."""
        try:
            service, type, arguments = parameter_call(request)
            sent, _ = self._factory.types.service(type)
            limit = self._client.limits.message
            message, _ = encode_json(sent, Encoding.CDR, arguments, 0, limit)
            self._begin_call(RequestService(request.number, service, type, message), request)
        except RTronError as error:
            self._listener.on_answer(request.number, error)

    def send_goal(self, request: SendGoal) -> None:
        """Send a goal, as soon as somebody serves the action."""
        timeout = int(self._client.limits.call_timeout * SECOND)
        try:
            goals = self._find_goals(request)
        except RTronError as error:
            self._listener.on_result(request.number, error)
        else:
            goals.send(request, self._factory.loop.now() + timeout)

    def cancel_goal(self, request: CancelGoal) -> None:
        """Ask for the cancel of a goal."""
        for goals in self._goals.values():
            goals.cancel(request.number)

    def close(self) -> None:
        """Leave the graph, once the goals that are not done are cancelled."""
        self.is_leaving = True
        for topic in list(self._outputs):
            self.withdraw(topic)
        for topic in list(self._read):
            self.leave(topic)
        for service in self._called.values():
            self._transport.remove_client(service)
        for goals in self._goals.values():
            goals.leave()
        self._leave_graph(self._factory.loop.now() + _FAREWELL)

    def _leave_graph(self, deadline: int) -> None:
        """Leave once no goal is left behind, at `deadline` (ns) in any case.

        A request is lost when its client goes before the server knows it.
        """
        now = self._factory.loop.now()
        if now < deadline and not all(goals.are_done for goals in self._goals.values()):
            self._factory.loop.call_at(now + _RETRY, partial(self._leave_graph, deadline))
            return
        for goals in self._goals.values():
            goals.close()
        self._factory.remove(self)

    def _find_goals(self, request: SendGoal) -> ClientGoals:
        if request.action not in self._goals:
            self._goals[request.action] = ClientGoals(
                self._factory.loop, self._transport, self._client.node, request, self._listener
            )
        return self._goals[request.action]

    def _service(self, request: RequestService) -> CalledService:
        name = request.service
        if name not in self._called:
            if len(self._called) >= _MAX_CALLED:
                raise SourceError(f"more than {_MAX_CALLED} services in one connection")
            package, _, last = request.type.replace("/srv/", "/").partition("/")
            self._called[name] = self._transport.create_client(
                self._client.node, name, f"{package}/srv/{last}", partial(self._finish, name)
            )
        return self._called[name]

    def _begin_call(self, request: RequestService, parameter: RequestParameter | None) -> None:
        now = self._factory.loop.now()
        self._open_calls = {
            key: call for key, call in self._open_calls.items() if call.deadline > now
        }
        deadline = now + int(self._client.limits.call_timeout * SECOND)
        call = _SentRequest(request.number, deadline, parameter)
        self._try_call(self._service(request), request, call)

    def _try_call(
        self, service: CalledService, request: RequestService, call: _SentRequest
    ) -> None:
        now = self._factory.loop.now()
        if self.is_leaving or now > call.deadline:
            return
        if not service.is_available:
            retry = partial(self._try_call, service, request, call)
            self._factory.loop.call_at(now + _RETRY, retry)
            return
        try:
            number = service.call(request.request)
        except RTronError as error:
            self._listener.on_answer(request.number, error)
            return
        self._open_calls[request.service, number] = call

    def _finish(self, service: str, number: int, response: bytes) -> None:
        call = self._open_calls.pop((service, number), None)
        if call is not None:
            parameter = call.parameter
            answer = self._parameter_answer(parameter, response) if parameter else response
            self._listener.on_answer(call.number, answer)

    def _parameter_answer(
        self, request: RequestParameter, response: bytes
    ) -> Document | RTronError:
        verbs = (ParameterVerb.GET, ParameterVerb.HAS)
        name = "GetParameters" if request.verb in verbs else "SetParameters"
        try:
            _, definition = self._factory.types.service(f"rcl_interfaces/{name}")
            return parameter_answer(request, decode_response(definition, Encoding.CDR, response))
        except RTronError as error:
            return error
