"""A client's node in ROS 1: a transport of its own, so that two clients may publish one topic."""

import json
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from rtron.bridge.common.client_node import NodeListener
from rtron.bridge.common.guarded_output import GuardedOutput
from rtron.bridge.common.message_types import MessageTypes
from rtron.bridge.protocol.effects import (
    CancelGoal,
    ParameterVerb,
    RequestParameter,
    RequestService,
    SendGoal,
)
from rtron.bridge.protocol.frames import Document
from rtron.bridge.rights.document import ClientRights
from rtron.errors import RTronError, SourceError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.protocol import (
    InputOptions,
    MessageHandler,
    OutputOptions,
    Peer,
    TypeInfo,
)
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.messages.ros1.service_types import service_md5sum
from rtron.vocabulary import SECOND, normalise_type
from rtron.wire.ros1.tcpros import ServiceCall, call_service
from rtron.wire.ros1.xmlrpc import RefusalError, ros_call

_METHODS = {
    ParameterVerb.GET: "getParam",
    ParameterVerb.SET: "setParam",
    ParameterVerb.HAS: "hasParam",
    ParameterVerb.DELETE: "deleteParam",
}


_MAX_THREADS = 128
"""How many threads call services for all clients; each client has an equal share, one at least."""
_TOO_LATE = "the call had to wait too long for others of yours"


class Ros1NodeFactory:
    """Opens nodes at one master."""

    def __init__(self, loop: EventLoop, master: str, types: MessageTypes, clients: int) -> None:
        """`clients` is how many there may be at most."""
        self._loop = loop
        self._master = master
        self._types = types
        self._share = max(1, _MAX_THREADS // max(1, clients))
        self._workers: dict[str, ThreadPoolExecutor] = {}

    def open(self, client: ClientRights, listener: NodeListener) -> "Ros1ClientNode":
        """Return the node of a client."""
        workers = self._workers_of(client)
        return Ros1ClientNode(self._loop, self._master, self._types, client, listener, workers)

    def _workers_of(self, client: ClientRights) -> ThreadPoolExecutor:
        """Return a client's threads, the same for all of its connections."""
        if client.name not in self._workers:
            count = min(client.limits.calls, self._share)
            workers = ThreadPoolExecutor(count, thread_name_prefix=client.node)
            self._workers[client.name] = workers
        return self._workers[client.name]

    def close(self) -> None:
        """End the threads; each node leaves by itself."""
        for workers in self._workers.values():
            workers.shutdown(wait=False, cancel_futures=True)


class Ros1ClientNode:
    """The topics, calls and parameters of one client; see `ClientNode`."""

    def __init__(
        self,
        loop: EventLoop,
        master: str,
        types: MessageTypes,
        client: ClientRights,
        listener: NodeListener,
        workers: ThreadPoolExecutor,
    ) -> None:
        self._loop = loop
        self._master = master
        self._types = types
        self._client = client
        self._listener = listener
        self._outputs: dict[str, GuardedOutput] = {}
        self._is_closed = False
        self._transport = Ros1Transport(loop, master)
        self._transport.set_shutdown_handler(lambda node, reason: listener.on_shutdown(reason))
        self._workers = workers

    def advertise(self, topic: str, type: str, listeners: tuple[str, ...]) -> None:
        """Publish a topic from now on, which these nodes of the guard hear, if any."""
        definition = self._types.message(type)
        name = normalise_type(type)
        queue_size = self._client.limits.queue
        output = self._transport.advertise(
            self._client.node,
            topic,
            name,
            OutputOptions(queue_size=queue_size, successors=listeners),
        )
        output.learn_type(TypeInfo(name, definition.md5sum, self._types.text(type)))
        self._outputs[topic] = GuardedOutput(
            self._loop, output, topic, name, listeners, self._listener.on_problem
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

    def read(self, topic: str, type: str) -> None:
        """Subscribe to a topic from now on."""
        md5sum = self._types.message(type).md5sum

        def accept(peer: Peer) -> MessageHandler | None:
            if peer.info.md5sum == md5sum:
                return lambda message: self._listener.on_message(topic, message)
            reason = f"{topic}: {peer.node} publishes another {peer.info.type} than is known here"
            self._listener.on_problem(reason)
            return None

        node, name = self._client.node, normalise_type(type)
        self._transport.subscribe(node, topic, name, accept, InputOptions())

    def leave(self, topic: str) -> None:
        """Subscribe to a topic no more."""
        self._transport.remove_subscription(self._client.node, topic)

    def call(self, request: RequestService) -> None:
        """Call a service in a thread."""
        parts = self._types.service(request.type)
        limits = self._client.limits
        call = ServiceCall(
            master=self._master,
            caller=self._client.node,
            service=request.service,
            type=request.type.replace("/srv/", "/"),
            md5sum=service_md5sum(*parts),
            request=request.request,
            max_response=limits.message,
            timeout=limits.call_timeout,
        )
        self._work(request.number, lambda: call_service(call))

    def access_parameter(self, request: RequestParameter) -> None:
        """Ask the master for a parameter, or set it, in a thread."""
        self._work(request.number, lambda: self._ask_master(request))

    def send_goal(self, request: SendGoal) -> None:
        """Never asked: in ROS 1 goals are messages."""
        reason = SourceError("in ROS 1 goals are messages")
        self._listener.on_result(request.number, reason)

    def cancel_goal(self, request: CancelGoal) -> None:
        """Never asked: in ROS 1 cancels are messages."""

    def close(self) -> None:
        """Leave the graph; answers to calls are not waited for."""
        self._is_closed = True
        self._transport.leave()

    def _ask_master(self, request: RequestParameter) -> Document:
        params = [request.name]
        if request.verb is ParameterVerb.SET:
            params.append(request.value)
        timeout = self._client.limits.call_timeout
        method = _METHODS[request.verb]
        try:
            found = ros_call(self._master, method, self._client.node, *params, timeout=timeout)
        except RefusalError:
            raise SourceError(f"there is no parameter {request.name}") from None
        if request.verb is ParameterVerb.GET:
            return {"value": json.dumps(found, default=str), "successful": True}
        return {"exists": bool(found)} if request.verb is ParameterVerb.HAS else {}

    def _work(self, number: int, work: Callable[[], Any]) -> None:
        deadline = self._loop.now() + int(self._client.limits.call_timeout * SECOND)
        future = self._workers.submit(self._work_in_time, work, deadline)
        future.add_done_callback(lambda done: self._loop.post(lambda: self._finish(number, done)))

    def _work_in_time(self, work: Callable[[], Any], deadline: int) -> Any:  # noqa: ANN401 - any answer
        """Work in a thread, unless nobody waits for the answer any more; SourceError then."""
        if self._is_closed or self._loop.now() > deadline:
            raise SourceError(_TOO_LATE)
        return work()

    def _finish(self, number: int, done: "Future[Any]") -> None:
        if self._is_closed or done.cancelled():
            return
        error = done.exception()
        if error is None:
            self._listener.on_answer(number, done.result())
        elif isinstance(error, RTronError):
            self._listener.on_answer(number, error)
        else:
            reason = f"the call has failed: {type(error).__name__}"
            self._listener.on_answer(number, SourceError(reason))
