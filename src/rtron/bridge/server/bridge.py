"""The bridge: it accepts connections, and knows which client is there.

Programs may open a WebSocket, and pages that the rights name, at a known host. A browser tells each
page's origin, and a page cannot change it; a name that an attacker's DNS points here is not a known
host (RFC 6455, section 10.2; DNS rebinding).
"""

import logging
import socket
from collections.abc import Iterable
from dataclasses import dataclass
from http import HTTPStatus
from ipaddress import ip_address
from typing import TYPE_CHECKING
from urllib.parse import parse_qs, urlsplit

from websockets.datastructures import Headers
from websockets.http11 import Request

from rtron.bridge.common.plan_topics import PlanTopics
from rtron.bridge.protocol.approvals import Approvals
from rtron.bridge.protocol.client_state import ClientRates
from rtron.bridge.protocol.session import ClientSession
from rtron.bridge.rights.document import BridgeRights
from rtron.bridge.rights.tokens import SignIn
from rtron.bridge.server.client_connection import ClientConnection
from rtron.errors import SourceError, WireError
from rtron.guard.transport.ros1.tcp_server import TcpServer
from rtron.service.server.connection_limit import ConnectionLimit

if TYPE_CHECKING:
    from rtron.bridge.common.client_node import NodeFactory
    from rtron.bridge.common.message_types import MessageTypes
    from rtron.guard.core.event_loop import EventLoop
    from rtron.vocabulary import Plan

_LOOPBACK = "localhost"
_MAX_PARAMETERS = 8


@dataclass(frozen=True, slots=True)
class OpeningRequest:
    """What a handshake asks for: `token` is empty where the client signs in later."""

    token: str = ""
    status: HTTPStatus = HTTPStatus.SWITCHING_PROTOCOLS
    reason: str = ""

    @property
    def is_refused(self) -> bool:
        """Whether there is to be no WebSocket."""
        return self.status is not HTTPStatus.SWITCHING_PROTOCOLS


def check_handshake(
    request: Request, hosts: Iterable[str], origins: Iterable[str]
) -> OpeningRequest:
    """Return what a handshake asks for, or why it is refused.

    `hosts` are names in small letters; addresses are always known: DNS cannot forge them.
    """
    host = _single(request.headers, "Host")
    if host is None or not _is_known(_host_name(host), hosts):
        return OpeningRequest("", HTTPStatus.MISDIRECTED_REQUEST, "there is no such host here")
    if not _is_allowed_origin(request.headers, host, origins):
        return OpeningRequest("", HTTPStatus.FORBIDDEN, "pages of that origin may not connect")
    return OpeningRequest(_token(request))


def known_hosts(rights: BridgeRights, host: str) -> frozenset[str]:
    """Return the names of this machine that clients may use, in small letters."""
    return frozenset(
        each.lower() for each in (_LOOPBACK, host, socket.gethostname(), *rights.hosts)
    )


def _single(headers: Headers, name: str) -> str | None:
    found = headers.get_all(name)
    return found[0] if len(found) == 1 else None


def _host_name(host: str) -> str:
    """Return the name in a Host header without its port, in small letters."""
    name, colon, port = host.rpartition(":")
    if not colon or not (port.isdigit() and port.isascii()) or name.endswith(":"):
        name = host
    return name.removeprefix("[").removesuffix("]").lower()


def _is_known(name: str, hosts: Iterable[str]) -> bool:
    try:
        ip_address(name)
    except ValueError:
        return name in hosts
    return True


def _is_allowed_origin(headers: Headers, host: str, origins: Iterable[str]) -> bool:
    """Tell whether a program asks, or a page that may; some programs name the bridge itself."""
    found = headers.get_all("Origin")
    if not found:
        return True
    origin = found[0].lower()
    own = {f"http://{host.lower()}", f"https://{host.lower()}"}
    return len(found) == 1 and origin in own | {each.lower() for each in origins}


def _token(request: Request) -> str:
    """Return the token of a handshake: a header, or `?token=` for pages that can send none."""
    scheme, _, token = (_single(request.headers, "Authorization") or "").partition(" ")
    if scheme.lower() == "bearer" and token.strip():
        return token.strip()
    try:
        found = parse_qs(urlsplit(request.path).query, max_num_fields=_MAX_PARAMETERS)
    except ValueError:
        return ""
    return found.get("token", [""])[0]


log = logging.getLogger(__name__)

MAX_STRANGERS = 64
"""How many connections may be there that have not signed in."""


class Bridge:
    """Serves the clients of one rights file in one ROS graph."""

    def __init__(
        self,
        loop: "EventLoop",
        plan: "Plan",
        rights: "BridgeRights",
        types: "MessageTypes",
        nodes: "NodeFactory",
    ) -> None:
        self.loop = loop
        self.nodes = nodes
        self.max_message = max((each.limits.message for each in rights.clients), default=1024)
        self.approvals = Approvals()
        self._ros = plan.ros
        self._rights = rights
        self._types = types
        self._topics = PlanTopics(plan)
        self._sign_in = SignIn(rights.clients)
        self._strangers = ConnectionLimit((), MAX_STRANGERS)
        self._connections: set[ClientConnection] = set()
        self._clients: dict[str, ClientConnection] = {}
        self._rates = {each.name: ClientRates() for each in rights.clients}
        self._hosts: frozenset[str] = frozenset()
        self._server: TcpServer | None = None

    def listen(self, host: str, port: int) -> int:
        """Accept connections from now on; return the port. SourceError if it is taken."""
        self._hosts = known_hosts(self._rights, host)
        try:
            self._server = TcpServer(self.loop, host, self._accept, port)
        except OSError as error:
            help = "choose another --port, or a --host of this machine"
            raise SourceError(f"{host}:{port}: {error.strerror}", help=help) from None
        return self._server.port

    def check(self, request: "Request") -> OpeningRequest:
        """Return what a handshake asks for, or why it is refused."""
        return check_handshake(request, self._hosts, self._rights.origins)

    def open_session(self, connection: ClientConnection, token: str) -> ClientSession:
        """Return the session of the client that a token is of, which has this connection now.

        WireError if the token is nobody's, the client is here already, or there are too many.
        """
        client = self._sign_in.find_client(token)
        if client is None:
            raise WireError("that token is nobody's")
        before = self._clients.get(client.name)
        if before and before.is_present:
            raise WireError(f"{client.name} is here already, from {before.address}")
        if not before and len(self._clients) >= self._rights.max_clients:
            raise WireError(f"{self._rights.max_clients} clients are here, more may not come")
        if before:
            before.close(_REPLACED, f"another connection of {client.name} takes over")
            before.drop()
        self._clients[client.name] = connection
        self._release(connection)
        rates = self._rates[client.name]
        return ClientSession(client, self._topics, self._types, self._ros, rates, self.approvals)

    def remove(self, connection: ClientConnection) -> None:
        """Forget a connection that has ended."""
        self._connections.discard(connection)
        if self._clients.get(connection.name) is connection:
            del self._clients[connection.name]
        if not connection.is_signed_in:
            self._release(connection)

    def close(self) -> None:
        """End all connections, and leave the graph."""
        if self._server:
            self._server.close()
        for connection in list(self._connections):
            connection.close(_GOING_AWAY, "the bridge ends")
            connection.drop()
        self.nodes.close()

    def _accept(self, sock: socket.socket) -> None:
        try:
            address = str(sock.getpeername()[0])
        except OSError:
            sock.close()
            return
        if not self._strangers.acquire(address):
            log.warning("%s is refused: too many connections have not signed in", address)
            sock.close()
            return
        connection = ClientConnection(self, sock, address)
        self._connections.add(connection)
        self._strangers.add_waiting(connection, connection.drop)

    def _release(self, connection: ClientConnection) -> None:
        self._strangers.remove_waiting(connection)
        self._strangers.release(connection.address)


_GOING_AWAY = 1001
_REPLACED = 4409
