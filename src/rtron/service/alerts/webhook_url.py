"""Where a webhook may lead: to any host but those that only clouds and this machine's link have.

A metadata service hands out credentials to whoever asks from this machine (SSRF). Names are looked
up here and the connection goes to the address that was checked, so a second answer of the DNS does
not lead elsewhere.
"""

import ipaddress
import socket
from dataclasses import dataclass
from urllib.parse import urlsplit

from rtron.errors import InputError, SourceError

_METADATA_ADDRESSES = frozenset(
    map(ipaddress.ip_address, ("100.100.100.200", "168.63.129.16", "192.0.0.192", "fd00:ec2::254"))
)
_PORTS = {"http": 80, "https": 443}

Address = ipaddress.IPv4Address | ipaddress.IPv6Address


@dataclass(frozen=True, slots=True, kw_only=True)
class WebhookUrl:
    """A URL taken apart: `url` is without name and password."""

    scheme: str
    host: str
    port: int
    path: str


def parse_webhook_url(url: str) -> WebhookUrl:
    """Return the parts of a webhook's URL; InputError if alerts may not go there."""
    try:
        parts = urlsplit(url)
        port, host = parts.port, parts.hostname
    except ValueError:
        raise InputError("the URL cannot be read", help="https://host/path") from None
    if parts.scheme not in _PORTS or not host or not url.isascii() or not url.isprintable():
        raise InputError("the URL cannot be read", help="https://host/path")
    if parts.username is not None or parts.password is not None:
        help = "put the secret into the path, or check the signature"
        raise InputError("no name and password in the URL", help=help)
    address = _ip_literal(host)
    if address and not _is_allowed(address):
        raise _forbidden_host_error(host)
    path = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
    return WebhookUrl(
        scheme=parts.scheme,
        host=host,
        port=_PORTS[parts.scheme] if port is None else port,
        path=path,
    )


def resolve_address(url: WebhookUrl) -> str:
    """Return an address of the host; SourceError if it has none, InputError if it is refused."""
    try:
        results = socket.getaddrinfo(url.host, url.port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        raise SourceError(f"{url.host} is not known here", help="check the name") from None
    addresses = [str(each[4][0]) for each in results]
    for each in addresses:
        if not _is_allowed(ipaddress.ip_address(each)):
            raise _forbidden_host_error(url.host)
    return addresses[0]


def _ip_literal(host: str) -> Address | None:
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None


def _is_allowed(address: Address) -> bool:
    unmapped = getattr(address, "ipv4_mapped", None) or address
    is_special = unmapped.is_link_local or unmapped.is_multicast or unmapped.is_unspecified
    return not (is_special or unmapped in _METADATA_ADDRESSES)


def _forbidden_host_error(host: str) -> InputError:
    help = "link-local, multicast and metadata addresses get no alerts"
    return InputError(f"{host} is not a place for alerts", help=help)
