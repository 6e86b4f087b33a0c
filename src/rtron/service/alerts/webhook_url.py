"""Where alerts may go: the URL of a webhook, and the address that its name stands for.

A metadata service hands out credentials to whoever asks from this machine (SSRF). Names are looked
up here and the connection goes to the address that was checked, so a second answer of the DNS does
not lead elsewhere.
"""

import ipaddress
import socket
from collections.abc import Iterator
from dataclasses import dataclass
from urllib.parse import urlsplit

from rtron.errors import InputError, SourceError

_METADATA_ADDRESSES = frozenset(
    map(ipaddress.ip_address, ("100.100.100.200", "168.63.129.16", "192.0.0.192"))
)
_METADATA_NETWORKS = tuple(map(ipaddress.IPv6Network, ("fd00:ec2::/32", "fd20:ce::/32")))
_IPV4_COMPATIBLE = ipaddress.IPv6Network("::/96")
_NAT64 = ipaddress.IPv6Network("64:ff9b::/96")
_TRANSLATED = ipaddress.IPv6Network("::ffff:0:0:0/96")
_LOCAL_NAT64 = ipaddress.IPv6Network("64:ff9b:1::/48")
_ISATAP, _ISATAP_MASK = 0x5EFE, 0xFDFF_FFFF
_IPV4_MASK = (1 << 32) - 1
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
    return not any(
        each.is_link_local
        or each.is_multicast
        or each.is_unspecified
        or each in _METADATA_ADDRESSES
        or any(each in network for network in _METADATA_NETWORKS)
        for each in (address, *_embedded_addresses(address))
    )


def _embedded_addresses(address: Address) -> Iterator[ipaddress.IPv4Address]:
    """Yield the IPv4 addresses that the network may take an IPv6 one for.

    RFC 4291, 3056 (6to4), 4380 (Teredo), 6052 (NAT64), 8215, 5214 (ISATAP), 7915.
    """
    if isinstance(address, ipaddress.IPv4Address):
        return
    yield from filter(None, (address.ipv4_mapped, address.sixtofour, *(address.teredo or ())))
    value = int(address)
    is_compatible = address in _IPV4_COMPATIBLE and not address.is_loopback
    is_isatap = value >> 32 & _ISATAP_MASK == _ISATAP
    if is_compatible or is_isatap or address in _NAT64 or address in _TRANSLATED:
        yield ipaddress.IPv4Address(value & _IPV4_MASK)
    if address in _LOCAL_NAT64:
        yield from map(ipaddress.IPv4Address, filter(None, _nat64_values(value)))


def _nat64_values(value: int) -> Iterator[int]:
    """Yield what an address may embed behind prefixes of 96, 64, 56 and 48 bits."""
    high, low = value >> 64 & 0xFFFF, value & ((1 << 64) - 1)
    yield low & _IPV4_MASK
    if not low >> 56:
        yield low >> 24
        yield (high & 0xFF) << 24 | low >> 32
        yield high << 16 | low >> 40


def _forbidden_host_error(host: str) -> InputError:
    help = "link-local, multicast and metadata addresses get no alerts"
    return InputError(f"{host} is not a place for alerts", help=help)
