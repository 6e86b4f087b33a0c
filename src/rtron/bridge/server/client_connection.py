"""A client's connection: its WebSocket, its session and its node, and what passes between them."""

import logging
import time
from typing import TYPE_CHECKING

from websockets.frames import CloseCode
from websockets.http11 import Request, Response

from rtron.bridge.common.client_node import ClientNode
from rtron.bridge.protocol import effects
from rtron.bridge.protocol.frames import NODE_HEADER, Document, decode_frame, encode_frame
from rtron.bridge.protocol.outbox import Outbox
from rtron.bridge.server.websocket import ServerWebSocket
from rtron.errors import RTronError, WireError
from rtron.guard.core.printable import printable
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    import socket

    from rtron.bridge.protocol.session import ClientSession
    from rtron.bridge.server.bridge import Bridge

log = logging.getLogger(__name__)

SIGN_IN_TIMEOUT_S = 10.0
_PING_S = 1.4
"""More than a second: ros-mcp waits so long for a status, and each ping begins its wait anew."""
_SILENT_AFTER = 30 * SECOND
"""A client that answers no ping for so long is gone, ns."""
_PRESENT_WITHIN = 3 * SECOND
"""A client that was heard within this time is there, ns."""
_OUTBOX_BYTES = 1 << 23
_UNAUTHORISED = 4401


class ClientConnection:
    """One connection from its handshake to its end; it is a client's once that has signed in."""

    def __init__(self, bridge: "Bridge", sock: "socket.socket", address: str) -> None:
        self._bridge = bridge
        self._loop = bridge.loop
        self.address = address
        self._session: ClientSession | None = None
        self._node: ClientNode | None = None
        self._outbox = Outbox(1, _OUTBOX_BYTES)
        self._tick_at: int | None = None
        self._socket = ServerWebSocket(self._loop, sock, self, bridge.max_message)
        self._loop.call_later(SIGN_IN_TIMEOUT_S, self._close_stranger)

    @property
    def name(self) -> str:
        """The name of the client, empty before its sign-in."""
        return self._session.client.name if self._session else ""

    @property
    def is_signed_in(self) -> bool:
        """Whether the client is known."""
        return self._session is not None

    @property
    def is_present(self) -> bool:
        """Whether the client was heard a moment ago."""
        return self._loop.now() - self._socket.last_received < _PRESENT_WITHIN

    def close(self, code: int, reason: str) -> None:
        """End the connection, and tell the client why."""
        self._socket.close(code, reason)

    def drop(self) -> None:
        """End the connection at once."""
        self._socket.drop("it had to go")

    def on_request(self, request: Request) -> Response:
        """See `SocketListener`."""
        handshake = self._bridge.check(request)
        if handshake.is_refused:
            return self._reject(handshake.status, handshake.reason)
        if handshake.token:
            try:
                self._sign_in(handshake.token)
            except WireError as error:
                return self._reject(401, str(error))
        headers = {NODE_HEADER: self._session.client.node} if self._session else {}
        return self._socket.accept(request, headers)

    def on_text(self, text: str) -> None:
        """See `SocketListener`."""
        if self._session is None:
            self._take_sign_in(text)
        else:
            self._carry_out(self._session.receive(text, self._loop.now(), time.time_ns()))

    def on_binary(self) -> None:
        """See `SocketListener`."""
        if self._session:
            reason = "binary frames are refused: send JSON"
            self._carry_out(self._session.tell(reason, self._loop.now()))

    def on_control(self) -> None:
        """See `SocketListener`."""
        if self._session:
            self._carry_out(self._session.note_control(self._loop.now()))

    def on_writable(self) -> None:
        """See `SocketListener`."""
        self._send()

    def on_close(self, reason: str) -> None:
        """See `SocketListener`."""
        node, self._node = self._node, None
        if self._session:
            log.info("%s has left: %s", self._session.client.node, printable(reason))
        elif reason:
            log.info("%s did not sign in: %s", self.address, printable(reason))
        if node:
            node.close()
        self._bridge.remove(self)

    def on_message(self, topic: str, message: bytes) -> None:
        """See `NodeListener`."""
        if self._session and self._node:
            self._carry_out(self._session.deliver(topic, message, self._loop.now()))

    def on_answer(self, number: int, answer: "bytes | Document | RTronError") -> None:
        """See `NodeListener`."""
        if self._session and self._node:
            self._carry_out(self._session.finish_call(number, answer))

    def on_feedback(self, number: int, feedback: bytes) -> None:
        """See `NodeListener`."""
        if self._session and self._node:
            now = self._loop.now()
            self._carry_out(self._session.deliver_feedback(number, feedback, now))

    def on_result(self, number: int, result: "bytes | RTronError") -> None:
        """See `NodeListener`."""
        if self._session and self._node:
            self._carry_out(self._session.finish_goal(number, result))

    def on_problem(self, reason: str) -> None:
        """See `NodeListener`."""
        if self._session and self._node:
            self._carry_out(self._session.tell(reason, self._loop.now()))

    def on_shutdown(self, reason: str) -> None:
        """See `NodeListener`."""
        self.close(CloseCode.GOING_AWAY, f"the node was shut down: {printable(reason)}")

    def _reject(self, status: int, reason: str) -> Response:
        log.warning("%s is refused: %s", self.address, reason)
        return self._socket.reject(status, reason)

    def _take_sign_in(self, text: str) -> None:
        """Take the first frame of a client without a token: `auth`, with the token as `mac`."""
        try:
            self._sign_in(_auth_token(text))
        except WireError as error:
            status = {"op": "status", "level": "error", "msg": str(error)}
            self._socket.send(encode_frame(status))
            self.close(_UNAUTHORISED, str(error))

    def _sign_in(self, token: str) -> None:
        """Become a client, whose node joins the graph; WireError if the token is nobody's."""
        self._session = session = self._bridge.open_session(self, token)
        client = session.client
        self._outbox = Outbox(client.limits.queue, _OUTBOX_BYTES)
        self._node = self._bridge.nodes.open(client, self)
        log.info("%s signs in from %s", client.node, self.address)
        self._loop.call_later(_PING_S, self._ping)

    def _carry_out(self, decided: list[effects.Effect]) -> None:
        for effect in decided:
            if self._node:
                self._apply_or_tell(effect, self._node)
        self._send()
        self._schedule_tick()

    def _apply_or_tell(self, effect: effects.Effect, node: ClientNode) -> None:
        """Carry an effect out; tell the client if the graph does not let it happen."""
        try:
            self._apply(effect, node)
        except RTronError as error:
            if self._session:
                self._carry_out(self._session.tell(str(error), self._loop.now()))

    def _apply(self, effect: effects.Effect, node: ClientNode) -> None:  # noqa: C901 - one for each
        match effect:
            case effects.SendAnswer(text):
                self._outbox.put_answer(text)
            case effects.SendMessage(frames):
                self._outbox.put_message(frames)
            case effects.AdvertiseTopic(topic, type, listeners):
                node.advertise(topic, type, listeners)
            case effects.WithdrawTopic(topic):
                node.withdraw(topic)
            case effects.PublishBytes(topic, message, is_latched):
                node.publish(topic, message, is_latched=is_latched)
            case effects.ReadTopic(topic, type):
                node.read(topic, type)
            case effects.LeaveTopic(topic):
                node.leave(topic)
            case effects.RequestService():
                node.call(effect)
            case effects.RequestParameter():
                node.access_parameter(effect)
            case effects.SendGoal():
                node.send_goal(effect)
            case effects.CancelGoal():
                node.cancel_goal(effect)
            case effects.CloseSession(reason):
                self.close(CloseCode.POLICY_VIOLATION, reason)

    def _send(self) -> None:
        """Send what waits, as far as the client reads; tell it what it was too slow for."""
        if self._outbox.is_overfull:
            self._socket.drop("it does not read its answers")
            return
        while self._socket.can_send and self._outbox:
            self._socket.send(self._outbox.pop())
        dropped = 0 if self._outbox else self._outbox.take_dropped()
        if dropped and self._session:
            reason = f"{dropped} messages were dropped: you read too slowly"
            self._carry_out(self._session.warn(reason))

    def _schedule_tick(self) -> None:
        at = self._session.next_tick if self._session else None
        if at is not None and (self._tick_at is None or at < self._tick_at):
            self._tick_at = at
            self._loop.call_at(at, self._tick)

    def _tick(self) -> None:
        self._tick_at = None
        if self._session and self._node:
            self._carry_out(self._session.tick(self._loop.now()))

    def _ping(self) -> None:
        if self._socket.is_closed:
            return
        if self._loop.now() - self._socket.last_received > _SILENT_AFTER:
            self.close(CloseCode.GOING_AWAY, "you answer no ping")
            return
        self._socket.ping()
        self._loop.call_later(_PING_S, self._ping)

    def _close_stranger(self) -> None:
        if not self.is_signed_in:
            self.close(_UNAUTHORISED, "no sign-in in time")


def _auth_token(text: str) -> str:
    """Return the token of an `auth` frame; WireError if it is none."""
    document = decode_frame(text)
    if document["op"] != "auth":
        raise WireError("sign in first: op `auth`, with your token as `mac`")
    return str(document.get("mac"))
