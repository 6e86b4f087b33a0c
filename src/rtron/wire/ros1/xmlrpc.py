"""XML-RPC as ROS 1 speaks it: the codec, and a client with one deadline for the whole call.

Both sides are strangers: no DTD or entity is accepted, sizes are bounded, and whatever is wrong
with a document is a WireError (ROS wiki: Master_Slave_APIs).
"""

import socket
import time
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit
from xml.parsers import expat
from xmlrpc.client import Fault, Unmarshaller, dumps

import h11

from rtron.errors import SourceError, WireError
from rtron.wire.ros1.network import HOST_NETWORK, Network

MAX_BODY = 1 << 24
"""The longest XML-RPC document accepted, bytes; a master's system state is the long one."""
MAX_DEPTH = 200
"""How deep the elements of a document may be nested."""
_MAX_TEXT = 500
_CHUNK = 1 << 16
_ROS_SUCCESS = 1
_RESPONSE_PARTS = 3


def encode_response(value: Any) -> bytes:  # noqa: ANN401
    """Return the XML of a method's answer."""
    return dumps((value,), methodresponse=True, allow_none=True).encode()


def decode_call(body: bytes) -> tuple[str, tuple[Any, ...]]:
    """Return a call's method name and parameters; WireError if the XML is not a call."""
    params, method = _parse(body)
    if not method:
        raise WireError("XML-RPC call without a method name")
    return method, params


def decode_response(body: bytes) -> Any:  # noqa: ANN401 - XML-RPC values have any type
    """Return the value of an answer; WireError if it is a fault or no answer."""
    params, _ = _parse(body)
    if len(params) != 1:
        raise WireError("XML-RPC answer without exactly one value")
    return params[0]


class _ShallowUnmarshaller(Unmarshaller):
    """The standard one, but a document cannot nest so deep that using its value would recurse."""

    def __init__(self) -> None:
        super().__init__(use_builtin_types=True)
        self.xml("", None)  # what it is given is text already
        self._depth = 0

    def start(self, tag: str, attrs: dict[str, str]) -> None:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise WireError(f"elements nested deeper than {MAX_DEPTH}")
        super().start(tag, attrs)

    def end(self, tag: str) -> None:
        self._depth -= 1
        super().end(tag)


def _parse(body: bytes) -> tuple[tuple[Any, ...], str | None]:
    if len(body) > MAX_BODY:
        raise WireError(f"XML-RPC document longer than {MAX_BODY} bytes")
    target = _ShallowUnmarshaller()
    try:
        _expat_parser(target).Parse(body, True)  # noqa: FBT003 - positional only
        return target.close(), target.getmethodname()
    except Fault as fault:
        raise WireError(f"XML-RPC fault: {_shortened(fault.faultString)}") from fault
    except Exception as error:  # the standard parser raises whatever a bad document provokes
        raise WireError(f"malformed XML-RPC: {_shortened(error)}") from error


def _expat_parser(target: _ShallowUnmarshaller) -> expat.XMLParserType:
    """Return a parser that refuses a DTD, without which there are no entities.

    defusedxml's does so too, but loads an HTTP server and pydoc: a twentieth of a guard's start.
    """
    parser = expat.ParserCreate()
    parser.StartElementHandler = target.start
    parser.EndElementHandler = target.end
    parser.CharacterDataHandler = target.data
    parser.StartDoctypeDeclHandler = _refuse_doctype
    return parser


def _refuse_doctype(*_: object) -> None:
    raise WireError("a DTD is not accepted")


def _shortened(text: object) -> str:
    """Return what a stranger says, short enough for a log."""
    return str(text)[:_MAX_TEXT]


class RefusalError(SourceError):
    """A ROS API has answered, and says no."""


def ros_call(
    uri: str,
    method: str,
    *params: Any,  # noqa: ANN401 - XML-RPC values have any type
    timeout: float,
    network: Network = HOST_NETWORK,
) -> Any:  # noqa: ANN401
    """Call a ROS API and return the value of its `[code, message, value]` answer.

    `timeout` (s) is for the whole call. SourceError if the node cannot be reached, does not
    answer in time or says no (RefusalError); WireError if its answer is not one.
    """
    answer = call(uri, method, *params, timeout=timeout, network=network)
    code, message, value = _reply_parts(answer, f"{method} at {uri}: ")
    if code != _ROS_SUCCESS:
        raise RefusalError(f"{method} at {uri}: {_shortened(message)}")
    return value


def decode_ros_reply(body: bytes) -> Any:  # noqa: ANN401
    """Return the value of a ROS API's `[code, message, value]`; WireError if it is none, or no."""
    code, _, value = _reply_parts(decode_response(body))
    if code != _ROS_SUCCESS:
        raise WireError("the answer is no")
    return value


def _reply_parts(answer: object, where: str = "") -> list[Any]:
    if not isinstance(answer, list) or len(answer) != _RESPONSE_PARTS:
        raise WireError(f"{where}the answer is not [code, message, value]")
    return answer


def call(
    uri: str,
    method: str,
    *params: Any,  # noqa: ANN401 - XML-RPC values have any type
    timeout: float,
    network: Network = HOST_NETWORK,
) -> Any:  # noqa: ANN401
    """Make one XML-RPC call; errors as in `ros_call`."""
    host, port = split_uri(uri)
    body = dumps(params, method, allow_none=True).encode()
    deadline = time.monotonic() + timeout
    try:
        with network.connect((host, port), timeout) as connection:
            connection.sendall(_request(host, body))
            return decode_response(b"".join(_body(connection, deadline)))
    except (OSError, UnicodeError) as error:
        raise SourceError(f"{method} at {uri}: {error}") from error
    except h11.ProtocolError as error:
        raise WireError(f"{method} at {uri}: {error}") from error


def split_uri(uri: object) -> tuple[str, int]:
    """Return host and port of an `http://host:port/` URI; WireError if it is not one."""
    try:
        parts = urlsplit(str(uri))
        if parts.scheme == "http" and parts.hostname and parts.port:
            return parts.hostname, parts.port
    except ValueError as error:
        raise WireError(f"not an XML-RPC address: {uri!r}") from error
    raise WireError(f"not an XML-RPC address: {uri!r}")


def _request(host: str, body: bytes) -> bytes:
    client = h11.Connection(h11.CLIENT)
    headers = [
        ("Host", host),
        ("Content-Type", "text/xml"),
        ("Content-Length", str(len(body))),
        ("Connection", "close"),
    ]
    head = client.send(h11.Request(method="POST", target="/RPC2", headers=headers)) or b""
    return head + (client.send(h11.Data(data=body)) or b"")


def _body(connection: socket.socket, deadline: float) -> Iterator[bytes]:
    client = h11.Connection(h11.CLIENT)
    client.send(h11.Request(method="POST", target="/RPC2", headers=[("Host", "-")]))
    client.send(h11.EndOfMessage())
    size = 0
    while True:
        event = client.next_event()
        if event is h11.NEED_DATA:
            client.receive_data(_receive(connection, deadline))
        elif isinstance(event, h11.Data):
            size += len(event.data)
            if size > MAX_BODY:
                raise WireError(f"XML-RPC answer longer than {MAX_BODY} bytes")
            yield bytes(event.data)
        elif isinstance(event, (h11.EndOfMessage, h11.ConnectionClosed)):
            return


def _receive(connection: socket.socket, deadline: float) -> bytes:
    left = deadline - time.monotonic()
    if left <= 0:
        raise TimeoutError("timed out")
    connection.settimeout(left)
    return connection.recv(_CHUNK)
