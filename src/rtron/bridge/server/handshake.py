"""Who may open a WebSocket: programs, and pages that the rights name, at a known host.

A browser tells each page's origin, and a page cannot change it; a name that an attacker's DNS
points here is not a known host (RFC 6455, section 10.2; DNS rebinding).
"""

import socket
from collections.abc import Iterable
from dataclasses import dataclass
from http import HTTPStatus
from ipaddress import ip_address
from urllib.parse import parse_qs, urlsplit

from websockets.datastructures import Headers
from websockets.http11 import Request

from rtron.bridge.rights.document import BridgeRights

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
