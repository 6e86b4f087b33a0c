"""A proxy before the private master: it answers what the plan forbids, and forwards the rest."""

import logging
import socket
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any
from xmlrpc.client import dumps

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import PERIOD, LogThrottle
from rtron.guard.master_proxy.access_rules import METHODS, MULTICALL, Topics, denial_reason
from rtron.guard.master_proxy.name_registry import NameRegistry
from rtron.guard.master_proxy.upstream import MAX_RESPONSE_BYTES, Upstream
from rtron.guard.transport.ros1.http_connection import HttpConnection, HttpLimits, MemoryBudget
from rtron.wire.ros1.xmlrpc import (
    MAX_BODY,
    decode_call,
    decode_response,
    encode_response,
    split_uri,
)

log = logging.getLogger(__name__)

_MAX_BUNDLED = 1 << 14


@dataclass(frozen=True, slots=True)
class ApiCall:
    """A method, its parameters, and the XML that says so."""

    method: str
    params: tuple[Any, ...]
    body: bytes

    @property
    def error_value(self) -> object:
        """The value beside an error."""
        return METHODS[self.method].error_value if self.method in METHODS else 0


def decode_calls(body: bytes) -> Sequence[ApiCall]:
    """Return a request's call; after a multicall follow those that it bundles.

    WireError if it is not XML-RPC, or if the master could not be told so.
    """
    method, params = decode_call(body)
    if method != MULTICALL:
        return (_encode_call(method, params),)
    bundled = [_bundled_call(each) for each in _bundled_values(params)]
    rewritten = [{"methodName": call.method, "params": list(call.params)} for call in bundled]
    return (_encode_call(MULTICALL, (rewritten,)), *bundled)


def _bundled_values(params: tuple[Any, ...]) -> list[Any]:
    if len(params) != 1 or not isinstance(params[0], list):
        raise WireError(f"{MULTICALL} takes a list of calls")
    if len(params[0]) > _MAX_BUNDLED:
        raise WireError(f"{MULTICALL} takes {_MAX_BUNDLED} calls at most")
    return params[0]


def _bundled_call(each: Any) -> ApiCall:  # noqa: ANN401 - a stranger's value
    match each:
        case {"methodName": str(method), "params": list(params), **others} if not others:
            return _encode_call(method, tuple(params))
    raise WireError(f"{MULTICALL} with something that is not a call")


def _encode_call(method: str, params: tuple[Any, ...]) -> ApiCall:
    try:
        return ApiCall(method, params, dumps(params, method, allow_none=True).encode())
    except (OverflowError, TypeError, ValueError, RecursionError) as error:
        raise WireError(f"{method[:80]!r} with a value that XML-RPC has no way to write") from error


_MAX_PER_PERIOD = 20
_MAX_LENGTH = 200


class RefusalLog:
    """The log of what the proxy refuses; a flood of callers with new names does not fill it."""

    def __init__(self, now: Callable[[], int]) -> None:
        self._now = now
        self._log_throttle = LogThrottle()
        self._period_start = now()
        self._logged_count = self._suppressed_count = 0

    def log_refusal(self, caller: object, method: str, why: str) -> None:
        """Log that a caller's call was refused."""
        now = self._now()
        if now - self._period_start >= PERIOD:
            self._begin_period(now)
        who = str(caller)[:_MAX_LENGTH]
        if self._logged_count >= _MAX_PER_PERIOD:
            self._suppressed_count += 1
        elif self._log_throttle.allows((who, why), now):
            self._logged_count += 1
            log.warning("refused: %s to %s: %s", method[:_MAX_LENGTH], ascii(who), why)

    def _begin_period(self, now: int) -> None:
        """Begin a new second; what was said in earlier ones no longer matters."""
        if self._suppressed_count:
            log.warning("refused: %d more", self._suppressed_count)
        self._log_throttle = LogThrottle()
        self._period_start = now
        self._logged_count = self._suppressed_count = 0


BOUNDS = HttpLimits(request=MAX_BODY, response=MAX_RESPONSE_BYTES)
MAX_CLIENTS = 1000
MAX_REQUEST_BYTES = 1 << 26
"""How many bytes of long calls all callers together may have under way."""
_SHORT_REQUEST = 1 << 16
_MOST_LONG = 32
_ERROR, _SUCCESS = -1, 1
_UNKNOWN = METHODS["getPid"]
_NO_ANSWER = "the master behind the proxy does not answer"

Reply = Callable[[bytes], None]


class MasterProxy:
    """What the proxy knows of the plan, the nodes and its callers."""

    def __init__(self, loop: EventLoop, topics: Topics, private: str, public: str) -> None:
        self.loop = loop
        self.topics = topics
        self.public = public
        self.private = split_uri(private)
        self.name_registry = NameRegistry(loop, topics, private)
        self.refusals = RefusalLog(loop.now)
        self.workers = ThreadPoolExecutor(2, thread_name_prefix="long calls")
        self.decoding_count = 0
        self.budget = MemoryBudget(MAX_REQUEST_BYTES)
        self.decoding_budget = MemoryBudget(MAX_REQUEST_BYTES)
        self._clients: OrderedDict[int, ProxyClient] = OrderedDict()

    def accept(self, sock: socket.socket) -> None:
        """Serve a caller; of too many, the one that has been silent for longest is let go."""
        caller = ProxyClient(self, sock)
        self._clients[id(caller)] = caller
        if len(self._clients) > MAX_CLIENTS:
            next(iter(self._clients.values())).close()

    def touch(self, caller: "ProxyClient") -> None:
        """Take note that a caller has spoken."""
        self._clients.move_to_end(id(caller))

    def forget(self, caller: "ProxyClient") -> None:
        """Forget a caller."""
        self._clients.pop(id(caller), None)

    def close(self) -> None:
        """Let all callers go."""
        for caller in list(self._clients.values()):
            caller.close()
        self.name_registry.close()
        self.workers.shutdown(wait=False, cancel_futures=True)


class ProxyClient:
    """One connection to the proxy, and its own one to the private master."""

    def __init__(self, proxy: MasterProxy, sock: socket.socket) -> None:
        self._proxy = proxy
        self._upstream = Upstream(proxy.loop, *proxy.private)
        self._has_left = False
        self._http = HttpConnection(proxy.loop, sock, self._serve, BOUNDS, proxy.budget)
        self._http.on_close = self._closed

    def close(self) -> None:
        """End the connection."""
        self._http.close()

    def _closed(self) -> None:
        self._has_left = True
        self._upstream.close()
        self._proxy.forget(self)

    def _serve(self, body: bytes) -> None:
        """Read a request, a long one in a thread of its own, so that it delays nobody else."""
        self._proxy.touch(self)
        if len(body) <= _SHORT_REQUEST:
            self._dispatch(decode_calls(body))
        elif self._proxy.decoding_count >= _MOST_LONG:
            raise WireError("too many long calls at once")
        else:
            self._proxy.decoding_budget.take(len(body))  # what is read outlasts its connection
            self._proxy.decoding_count += 1
            work = self._proxy.workers.submit(decode_calls, body)
            read = partial(self._on_decoded, size=len(body))
            work.add_done_callback(lambda w: self._proxy.loop.post(partial(read, w)))

    def _on_decoded(self, work: "Future[Sequence[ApiCall]]", *, size: int) -> None:
        self._proxy.decoding_count -= 1
        self._proxy.decoding_budget.release(size)
        try:
            self._dispatch(work.result())
        except WireError:
            self._http.close()

    def _dispatch(self, calls: Sequence[ApiCall]) -> None:
        first = calls[0]
        if first.method != MULTICALL:
            self._call(first, self._http.reply)
        elif all(self._is_plain(call) for call in calls[1:]):
            self._forward(first, self._http.reply)
        else:
            self._call_sequentially(iter(calls[1:]), [])

    def _is_plain(self, call: ApiCall) -> bool:
        """Tell whether a call may go on as it is, and its answer come back so."""
        needs_rewrite = call.method == "getUri" or METHODS.get(call.method, _UNKNOWN).uri_index
        return not needs_rewrite and not denial_reason(self._proxy.topics, call.method, call.params)

    def _call_sequentially(self, calls: Iterator[ApiCall], values: list[Any]) -> None:
        """Take a multicall apart; its answer is a list of lists of one value."""
        call = next(calls, None)
        if call is None:
            self._http.reply(encode_response(values))
            return

        def answered(body: bytes) -> None:
            values.append([_response_value(body)])
            self._proxy.loop.call_after_event(lambda: self._call_sequentially(calls, values))

        self._call(call, answered)

    def _call(self, call: ApiCall, reply: Reply) -> None:
        proxy, api = self._proxy, METHODS.get(call.method, _UNKNOWN)
        if why := denial_reason(proxy.topics, call.method, call.params):
            self._refuse(call, reply, why)
        elif api.uri_index:
            name, uri = call.params[0], call.params[api.uri_index]
            proxy.name_registry.admit(name, uri, partial(self._on_admitted, call, reply))
        else:
            self._forward(call, reply)

    def _on_admitted(self, call: ApiCall, reply: Reply, why: str) -> None:
        if why:
            self._refuse(call, reply, why)
        else:
            self._forward(call, reply)

    def _refuse(self, call: ApiCall, reply: Reply, why: str) -> None:
        caller = call.params[0] if call.params else ""
        self._proxy.refusals.log_refusal(caller, call.method, why)
        reply(encode_response([_ERROR, f"refused by rtron master: {why}", call.error_value]))

    def _forward(self, call: ApiCall, reply: Reply) -> None:
        if not self._has_left:
            self._upstream.call(call.body, lambda body: reply(self._client_response(call, body)))

    def _client_response(self, call: ApiCall, body: bytes | None) -> bytes:
        """Return what a caller is told of the private master's answer.

        Publishers need no addresses of subscribers, and no client library looks at them.
        """
        if body is None:
            return encode_response([_ERROR, _NO_ANSWER, call.error_value])
        if call.method == "getUri":
            return encode_response([_SUCCESS, "", self._proxy.public])
        if call.method == "registerPublisher":
            return encode_response([*_response_value(body)[:2], []])
        return body


def _response_value(answer: bytes) -> list[Any]:
    """Return the `[code, message, value]` of an answer; one that is none is an error."""
    try:
        value = decode_response(answer)
    except WireError as error:
        return [_ERROR, str(error), 0]
    return value if isinstance(value, list) else [_ERROR, _NO_ANSWER, 0]
