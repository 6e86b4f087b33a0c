"""The connection of an agent's server to the bridge: rosbridge v2, as any other client's."""

import asyncio
import json
from collections.abc import Callable, Mapping
from contextlib import AsyncExitStack, suppress
from itertools import count
from typing import Any

from websockets.asyncio.client import ClientConnection as ClientSocket
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus, InvalidURI

from rtron.bridge.protocol.frames import NODE_HEADER
from rtron.errors import SourceError, WireError

Frame = dict[str, Any]
OnMessage = Callable[[str, Frame], None]
"""Takes a topic and its message."""

TIMEOUT_S = 5.0
_MAX_FRAME = 1 << 22
_MAX_REASONS = 64
_QUEUE = 16
_WITH_ANSWER = "ask:"
"""Begins the ids of frames that get an answer, which has the reason of a refusal, too."""


class BridgeLink:
    """One client of a bridge; WireError is what the bridge refuses, SourceError that it is away."""

    def __init__(self, node: str, address: str, token: str, on_message: OnMessage) -> None:
        self._node = node
        self._address = address
        self._token = token
        self._on_message = on_message
        self._socket: ClientSocket | None = None
        self._stack = AsyncExitStack()
        self._reader: asyncio.Task[None] | None = None
        self._ids = count(1)
        self._answers: dict[str, asyncio.Future[Frame]] = {}
        self._refusal = ""
        self._reasons: dict[str, str] = {}
        self._goals: dict[str, list[str]] = {}

    @property
    def is_open(self) -> bool:
        """Whether the bridge is there."""
        return self._reader is not None and not self._reader.done()

    async def open(self) -> None:
        """Sign in; SourceError also if the token is of another node, and ever after."""
        if self._refusal:
            raise SourceError(self._refusal)
        headers = {"Authorization": f"Bearer {self._token}"}
        connecting = connect(
            self._address,
            additional_headers=headers,
            compression=None,
            proxy=None,
            max_size=_MAX_FRAME,
            open_timeout=TIMEOUT_S,
        )
        try:
            self._socket = await self._stack.enter_async_context(connecting)
        except InvalidStatus as error:
            body = (error.response.body or b"").decode(errors="replace")[:200]
            reason = body.strip() or error.response.reason_phrase
            raise SourceError(f"the bridge refuses: {reason}") from None
        except (OSError, asyncio.TimeoutError, InvalidHandshake, InvalidURI) as error:
            help = "start it with `rtron bridge`, and name its address with --bridge"
            raise SourceError(f"no bridge at {self._address}: {error}", help=help) from None
        self._reader = asyncio.create_task(self._read(self._socket))
        await self._check_node(self._socket)

    async def _check_node(self, socket: ClientSocket) -> None:
        """Leave if the token belongs to another node: the tools would report that node's flow."""
        headers = socket.response.headers if socket.response else {}
        node = headers.get(NODE_HEADER, "")
        if node == self._node:
            return
        await self.close()
        self._refusal = (
            f"the token is of {node[:80]}, not of {self._node}: start again with its name"
            if node
            else f"the bridge does not say whose the token is: update it, or let {NODE_HEADER} pass"
        )
        raise SourceError(self._refusal)

    async def close(self) -> None:
        """Leave."""
        await self._stack.aclose()
        if self._reader:
            await self._reader

    async def advertise(self, topic: str, type: str) -> None:
        """Publish a topic from now on."""
        await self._send({"op": "advertise", "topic": topic, "type": type})

    async def subscribe(self, topic: str, type: str) -> None:
        """Hear a topic from now on; what comes too fast waits, so that the newest is not lost."""
        frame = {"op": "subscribe", "topic": topic, "type": type, "queue_length": _QUEUE}
        await self._send(frame)

    async def publish(self, topic: str, type: str, message: object) -> None:
        """Publish a message; what the bridge says of it comes with `settle`."""
        await self._send({"op": "publish", "topic": topic, "type": type, "msg": message})

    async def settle(self) -> None:
        """Wait until the bridge has seen all that was sent; WireError if it has refused any."""
        await self.call("/rosapi/get_time", {})
        if self._reasons:
            reasons = list(self._reasons.values())
            self._reasons.clear()
            raise WireError(reasons[0])

    async def call(self, service: str, args: Mapping[str, object]) -> Frame:
        """Return the answer of a service."""
        frame = {"op": "call_service", "service": service, "args": args}
        answer = await self._ask(frame, TIMEOUT_S)
        values = answer.get("values")
        if answer.get("result") is not True:
            raise WireError(str(values))
        return values if isinstance(values, dict) else {}

    async def send_goal(self, action: str, type: str, goal: object, patience_s: float) -> Frame:
        """Send a goal of an action of ROS 2; return its result."""
        frame = {"op": "send_action_goal", "action": action, "action_type": type, "args": goal}
        return await self._ask(frame, patience_s, self._goals.setdefault(action, []))

    async def cancel_goals(self, action: str) -> None:
        """Cancel all goals that were sent to an action of ROS 2 and may not be done."""
        for id in self._goals.pop(action, []):
            await self._send({"op": "cancel_action_goal", "action": action, "id": id})

    async def _ask(self, frame: Frame, patience_s: float, ids: list[str] | None = None) -> Frame:
        """Send a frame, and return the answer that has its id, which is added to `ids`."""
        id = f"{_WITH_ANSWER}{next(self._ids)}"
        if ids is not None:
            ids.append(id)
        answer = self._answers[id] = asyncio.get_running_loop().create_future()
        try:
            await self._send({**frame, "id": id})
            return await asyncio.wait_for(answer, patience_s)
        except asyncio.TimeoutError:
            raise SourceError("the bridge does not answer") from None
        finally:
            self._answers.pop(id, None)

    async def _send(self, frame: Frame) -> None:
        if self._socket is None or not self.is_open:
            raise SourceError("the connection to the bridge has ended")
        try:
            text = json.dumps({"id": f"say:{next(self._ids)}", **frame}, allow_nan=False)
            await self._socket.send(text)
        except ValueError:
            raise WireError("NaN and Inf are no numbers of JSON") from None
        except ConnectionClosed as error:
            raise SourceError(f"the connection to the bridge has ended: {error}") from None

    async def _read(self, socket: ClientSocket) -> None:
        with suppress(ConnectionClosed):
            async for text in socket:
                self._take(json.loads(text))
        for each in self._answers.values():
            if not each.done():
                each.set_exception(SourceError("the connection to the bridge has ended"))

    def _take(self, frame: Frame) -> None:
        op, id = frame.get("op"), str(frame.get("id", ""))
        if op == "publish":
            self._on_message(str(frame["topic"]), frame["msg"])
        elif op in ("service_response", "action_result"):
            answer = self._answers.get(id)
            if answer and not answer.done():
                answer.set_result(frame)
        elif op == "status" and frame.get("level") == "error":
            self._note_reason(id, str(frame.get("msg")))

    def _note_reason(self, id: str, reason: str) -> None:
        """Keep why a frame was refused that gets no answer."""
        if not id.startswith(_WITH_ANSWER) and len(self._reasons) < _MAX_REASONS:
            self._reasons[id] = reason
