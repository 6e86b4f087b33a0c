"""Stands before the private master: what the plan forbids is answered here, the rest there.

What goes on is written anew from what was understood, never the caller's own bytes. rospy bundles
calls in `system.multicall` (when it leaves, and to set parameters): each is judged by itself.
"""

import socket
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any
from xmlrpc.client import dumps

from rtron.errors import WireError
from rtron.guard.core.event_loop import Loop
from rtron.guard.master_proxy.access_rules import APIS, MULTICALL, Topics, forbidden
from rtron.guard.master_proxy.name_registry import Standing
from rtron.guard.master_proxy.refusal_log import Refusals
from rtron.guard.master_proxy.upstream import MOST, Upstream
from rtron.guard.transport.ros1.http_connection import Bounds, Budget, HttpConnection
from rtron.wire.ros1.xmlrpc import (
    MAX_BODY,
    decode_call,
    decode_response,
    encode_response,
    split_uri,
)

BOUNDS = Bounds(request=MAX_BODY, unread=MOST)
MOST_CALLERS = 1000
MOST_ASKED = 1 << 26
"""How many bytes of long calls all callers together may have under way."""
_SHORT = 1 << 16
_MOST_BUNDLED = 1 << 14
_MOST_LONG = 32
_ERROR, _SUCCESS = -1, 1
_NO_ANSWER = "the master behind the fence does not answer"

Reply = Callable[[bytes], None]


@dataclass(frozen=True, slots=True)
class Call:
    """A method, its parameters, and the XML that says so."""

    method: str
    params: tuple[Any, ...]
    body: bytes

    @property
    def nothing(self) -> object:
        """The value beside an error."""
        return APIS[self.method].nothing if self.method in APIS else 0


class Proxy:
    """What the fence knows of the plan, the nodes and its callers."""

    def __init__(self, loop: Loop, topics: Topics, private: str, public: str) -> None:
        self.loop = loop
        self.topics = topics
        self.public = public
        self.private = split_uri(private)
        self.standing = Standing(loop, topics, private)
        self.refusals = Refusals(loop.now)
        self.workers = ThreadPoolExecutor(2, thread_name_prefix="long calls")
        self.reading = 0
        self.budget = Budget(MOST_ASKED)
        self.read_budget = Budget(MOST_ASKED)
        self._callers: OrderedDict[int, Caller] = OrderedDict()

    def accept(self, sock: socket.socket) -> None:
        """Serve a caller; of too many, the one that has been silent for longest is let go."""
        caller = Caller(self, sock)
        self._callers[id(caller)] = caller
        if len(self._callers) > MOST_CALLERS:
            next(iter(self._callers.values())).close()

    def heard(self, caller: "Caller") -> None:
        """Take note that a caller has spoken."""
        self._callers.move_to_end(id(caller))

    def left(self, caller: "Caller") -> None:
        """Forget a caller."""
        self._callers.pop(id(caller), None)

    def close(self) -> None:
        """Let all callers go."""
        for caller in list(self._callers.values()):
            caller.close()
        self.standing.close()
        self.workers.shutdown(wait=False, cancel_futures=True)


class Caller:
    """One connection to the fence, and its own one to the private master."""

    def __init__(self, proxy: Proxy, sock: socket.socket) -> None:
        self._proxy = proxy
        self._upstream = Upstream(proxy.loop, *proxy.private)
        self._has_left = False
        self._http = HttpConnection(proxy.loop, sock, self._serve, BOUNDS, proxy.budget)
        self._http.closed = self._closed

    def close(self) -> None:
        """End the connection."""
        self._http.close()

    def _closed(self) -> None:
        self._has_left = True
        self._upstream.close()
        self._proxy.left(self)

    def _serve(self, body: bytes) -> None:
        """Read a request, a long one in a thread of its own, so that it delays nobody else."""
        self._proxy.heard(self)
        if len(body) <= _SHORT:
            self._take(understood(body))
        elif self._proxy.reading >= _MOST_LONG:
            raise WireError("too many long calls at once")
        else:
            self._proxy.read_budget.take(len(body))  # what is read outlasts its connection
            self._proxy.reading += 1
            work = self._proxy.workers.submit(understood, body)
            read = partial(self._take_read, size=len(body))
            work.add_done_callback(lambda w: self._proxy.loop.post(partial(read, w)))

    def _take_read(self, work: "Future[Sequence[Call]]", *, size: int) -> None:
        self._proxy.reading -= 1
        self._proxy.read_budget.release(size)
        try:
            self._take(work.result())
        except WireError:
            self._http.close()

    def _take(self, calls: "Sequence[Call]") -> None:
        first = calls[0]
        if first.method != MULTICALL:
            self._call(first, self._http.reply)
        elif all(self._is_plain(call) for call in calls[1:]):
            self._forward(first, self._http.reply)
        else:
            self._one_by_one(iter(calls[1:]), [])

    def _is_plain(self, call: Call) -> bool:
        """Tell whether a call may go on as it is, and its answer come back so."""
        asked = call.method == "getUri" or APIS.get(call.method, _UNKNOWN).caller_api
        return not asked and not forbidden(self._proxy.topics, call.method, call.params)

    def _one_by_one(self, calls: Iterator[Call], values: list[Any]) -> None:
        """Take a multicall apart; its answer is a list of lists of one value."""
        call = next(calls, None)
        if call is None:
            self._http.reply(encode_response(values))
            return

        def answered(body: bytes) -> None:
            values.append([_value(body)])
            self._proxy.loop.after(lambda: self._one_by_one(calls, values))

        self._call(call, answered)

    def _call(self, call: Call, reply: Reply) -> None:
        proxy, api = self._proxy, APIS.get(call.method, _UNKNOWN)
        if why := forbidden(proxy.topics, call.method, call.params):
            self._refuse(call, reply, why)
        elif api.caller_api:
            name, uri = call.params[0], call.params[api.caller_api]
            proxy.standing.admit(name, uri, partial(self._admitted, call, reply))
        else:
            self._forward(call, reply)

    def _admitted(self, call: Call, reply: Reply, why: str) -> None:
        if why:
            self._refuse(call, reply, why)
        else:
            self._forward(call, reply)

    def _refuse(self, call: Call, reply: Reply, why: str) -> None:
        caller = call.params[0] if call.params else ""
        self._proxy.refusals.note(caller, call.method, why)
        reply(encode_response([_ERROR, f"refused by rtron master: {why}", call.nothing]))

    def _forward(self, call: Call, reply: Reply) -> None:
        if not self._has_left:
            self._upstream.call(call.body, lambda body: reply(self._told(call, body)))

    def _told(self, call: Call, body: bytes | None) -> bytes:
        """Return what a caller is told of the private master's answer.

        Publishers need no addresses of subscribers, and no client library looks at them.
        """
        if body is None:
            return encode_response([_ERROR, _NO_ANSWER, call.nothing])
        if call.method == "getUri":
            return encode_response([_SUCCESS, "", self._proxy.public])
        if call.method == "registerPublisher":
            return encode_response([*_value(body)[:2], []])
        return body


def _value(answer: bytes) -> list[Any]:
    """Return the `[code, message, value]` of an answer; one that is none is an error."""
    try:
        value = decode_response(answer)
    except WireError as error:
        return [_ERROR, str(error), 0]
    return value if isinstance(value, list) else [_ERROR, _NO_ANSWER, 0]


_UNKNOWN = APIS["getPid"]


def understood(body: bytes) -> "Sequence[Call]":
    """Return a request's call; after a multicall follow those that it bundles.

    WireError if it is not XML-RPC, or if the master could not be told so.
    """
    method, params = decode_call(body)
    if method != MULTICALL:
        return (_written(method, params),)
    bundled = [_bundled(each) for each in _bundle(params)]
    again = [{"methodName": call.method, "params": list(call.params)} for call in bundled]
    return (_written(MULTICALL, (again,)), *bundled)


def _bundle(params: tuple[Any, ...]) -> list[Any]:
    if len(params) != 1 or not isinstance(params[0], list):
        raise WireError(f"{MULTICALL} takes a list of calls")
    if len(params[0]) > _MOST_BUNDLED:
        raise WireError(f"{MULTICALL} takes {_MOST_BUNDLED} calls at most")
    return params[0]


def _bundled(each: Any) -> Call:  # noqa: ANN401 - a stranger's value
    match each:
        case {"methodName": str(method), "params": list(params), **others} if not others:
            return _written(method, tuple(params))
    raise WireError(f"{MULTICALL} with something that is not a call")


def _written(method: str, params: tuple[Any, ...]) -> Call:
    try:
        return Call(method, params, dumps(params, method, allow_none=True).encode())
    except (OverflowError, TypeError, ValueError, RecursionError) as error:
        raise WireError(f"{method[:80]!r} with a value that XML-RPC has no way to write") from error
