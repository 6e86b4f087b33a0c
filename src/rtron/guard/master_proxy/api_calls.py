"""Calls of the Master API, read and written anew: no byte of a caller's goes on to the master.

rospy bundles calls in `system.multicall` when it leaves, and to set parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from xmlrpc.client import dumps

from rtron.errors import WireError
from rtron.guard.master_proxy.access_rules import METHODS, MULTICALL
from rtron.wire.ros1.xmlrpc import decode_call

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
