"""Requests and responses through rcl's C interface (rcl/service.h, rcl/client.h, rmw/types.h).

rclpy does not say who sent a request, and responds only to request ids that it gave out itself. rcl
does both: the first 12 bytes of the writer's GUID are the client's participant, and a request id is
that GUID with a number, which a guard can hand over to the next one.
"""

from __future__ import annotations

import ctypes
from contextlib import contextmanager
from ctypes import byref, c_bool, c_int, c_int64, c_void_p, py_object
from functools import lru_cache
from typing import TYPE_CHECKING, Any
from weakref import finalize

from rtron.errors import WireError
from rtron.wire.ros2.c_structures import RequestId, ServiceInfo, capsule_pointer, typed_function

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.transport.ros2.sender_ids import SenderIds

_OK, _TIMED_OUT = 0, 2
_NO_MESSAGE = frozenset({401, 501, 601})
"""RCL_RET_{SUBSCRIPTION,CLIENT,SERVICE}_TAKE_FAILED (rcl/types.h), Foxy and later."""
_POINTERS = c_void_p, c_void_p, c_void_p


def request_id_parts(request_id: bytes) -> tuple[bytes, int]:
    """Return the GUID of the writer of a request, and the number of the request."""
    parts = RequestId.from_buffer_copy(request_id)
    return bytes(parts.guid), int(parts.number)


class _MessageConverter:
    """Converts messages of a class to rcl's, and back (rosidl_generator_py)."""

    def __init__(self, cls: Any) -> None:  # noqa: ANN401 - a generated class
        meta = type(cls)
        if meta._TYPE_SUPPORT is None:  # noqa: SLF001 - as rclpy does
            meta.__import_type_support__()
        self.create = ctypes.CFUNCTYPE(c_void_p)(capsule_pointer(meta._CREATE_ROS_MESSAGE))  # noqa: SLF001
        self.destroy = ctypes.CFUNCTYPE(None, c_void_p)(capsule_pointer(meta._DESTROY_ROS_MESSAGE))  # noqa: SLF001
        fill = ctypes.PYFUNCTYPE(c_bool, py_object, c_void_p)
        self.from_python = fill(capsule_pointer(meta._CONVERT_FROM_PY))  # noqa: SLF001
        read = ctypes.PYFUNCTYPE(py_object, c_void_p)
        self.to_python = read(capsule_pointer(meta._CONVERT_TO_PY))  # noqa: SLF001

    @contextmanager
    def new_message(self) -> Iterator[int]:
        """Yield an empty message of rcl's."""
        message = self.create()
        try:
            yield message
        finally:
            self.destroy(message)


class ServiceMessage:
    """A request or a response of rcl; only `decode` makes it rclpy's object."""

    def __init__(self, cls: type) -> None:
        self._cls = cls
        self._converter = _converter_for(cls)
        self.message = self._converter.create()
        finalize(self, self._converter.destroy, self.message).atexit = False

    def decode(self) -> Any:  # noqa: ANN401 - a generated class
        """Return rclpy's object; WireError if the message is invalid."""
        try:
            return self._converter.to_python(self.message)
        except (ValueError, AssertionError) as error:
            raise WireError(f"it is no {self._cls.__name__}: {error}") from error


class ServiceCalls:
    """Calls of rcl; services and clients are rclpy's handles, messages rclpy's objects."""

    def __init__(self, sender_ids: SenderIds) -> None:
        self._ids = sender_ids
        rcl, utils = ctypes.CDLL("librcl.so"), ctypes.CDLL("librcutils.so")
        self._take_request = typed_function(rcl.rcl_take_request_with_info, c_int, *_POINTERS)
        self._send_response = typed_function(rcl.rcl_send_response, c_int, *_POINTERS)
        self._take_response = typed_function(rcl.rcl_take_response_with_info, c_int, *_POINTERS)
        self._send_request = typed_function(rcl.rcl_send_request, c_int, *_POINTERS)
        self._reset = typed_function(utils.rcutils_reset_error, None)

    def take_request(self, service: Any, cls: type) -> tuple[bytes, ServiceMessage] | None:  # noqa: ANN401
        """Return the id of the next request and the request, undecoded; None if there is none.

        WireError if it cannot be taken.
        """
        info = ServiceInfo()
        request = self._take_message(self._take_request, service, cls, info)
        return None if request is None else (self._ids.request_id(bytes(info.request_id)), request)

    def respond(self, service: Any, request_id: bytes, response: object) -> bool:  # noqa: ANN401
        """Respond to a request; nothing happens if its client is gone.

        False if the client and the service do not know each other yet, for which rcl waits 100 ms.
        """
        cls: Any = type(response)
        converter = _converter_for(cls)
        with converter.new_message() as message:
            converter.from_python(response, message)
            header = RequestId.from_buffer_copy(self._ids.rmw_request_id(request_id))
            code = self._send_response(service.pointer, byref(header), message)
        if code != _TIMED_OUT:
            self._check(code, "respond to a request")
        self._reset()
        return bool(code != _TIMED_OUT)

    def send_request(self, client: Any, request: object) -> int:  # noqa: ANN401 - rclpy's handle
        """Send a request; return its number."""
        cls: Any = type(request)
        converter, number = _converter_for(cls), c_int64()
        with converter.new_message() as message:
            converter.from_python(request, message)
            code = self._send_request(client.pointer, message, byref(number))
            self._check(code, "send a request")
        return number.value

    def take_response(self, client: Any, cls: type) -> tuple[int, Any] | None:  # noqa: ANN401
        """Return the next response, and the number of its request; None if there is none.

        WireError if it cannot be read.
        """
        info = ServiceInfo()
        response = self._take_message(self._take_response, client, cls, info)
        return None if response is None else (info.request_id.number, response.decode())

    def _take_message(
        self,
        take: Any,  # noqa: ANN401 - ctypes
        handle: Any,  # noqa: ANN401 - rclpy's handle
        cls: type,
        info: ServiceInfo,
    ) -> ServiceMessage | None:
        message = ServiceMessage(cls)
        code = take(handle.pointer, byref(info), message.message)
        if code in _NO_MESSAGE:
            self._reset()
            return None
        self._check(code, "take a request or a response")
        return message

    def _check(self, code: int, what: str) -> None:
        if code != _OK:
            self._reset()
            raise WireError(f"rcl cannot {what}: error {code}")


@lru_cache(maxsize=256)
def _converter_for(cls: Any) -> _MessageConverter:  # noqa: ANN401 - a generated class
    return _MessageConverter(cls)
