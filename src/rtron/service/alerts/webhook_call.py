"""Where alerts may go, and one call there: signed, in bounded time, following no redirect.

A metadata service hands out credentials to whoever asks from this machine (SSRF). Names are looked
up here and the connection goes to the address that was checked, so a second answer of the DNS does
not lead elsewhere.
"""

import hashlib
import hmac
import ipaddress
import socket
import ssl
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from urllib.parse import urlsplit, urlunsplit

import httpx
from anyio import fail_after, to_thread

from rtron.errors import InputError, RTronError, SourceError

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


SIGNATURE_HEADER = "X-RTron-Signature"
TIMESTAMP_HEADER = "X-RTron-Timestamp"
_TIMEOUT_S = 10.0


class WebhookCallError(Exception):
    """A webhook was not reached or did not take the alert; the text holds nothing of its URL."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WebhookCall:
    """An alert for one webhook, as bytes."""

    url: str
    secret: str
    body: bytes


def new_client() -> httpx.AsyncClient:
    """Return a client that uses no proxy and no password of the environment."""
    return httpx.AsyncClient(
        verify=_tls_context(), trust_env=False, follow_redirects=False, timeout=_TIMEOUT_S
    )


@cache
def _tls_context() -> ssl.SSLContext:
    """Return what all clients trust: to read the authorities takes 20 ms."""
    return httpx.create_ssl_context(trust_env=False)


async def send_call(client: httpx.AsyncClient, call: WebhookCall, timestamp: int) -> None:
    """Send a webhook call, `timestamp` since 1970; WebhookCallError says why it failed."""
    try:
        with fail_after(_TIMEOUT_S):
            target = parse_webhook_url(call.url)
            address = await to_thread.run_sync(resolve_address, target, abandon_on_cancel=True)
            status = await _status(client, _request(client, target, address, call, timestamp))
    except TimeoutError:
        raise WebhookCallError("no answer in time") from None
    except RTronError as error:
        raise WebhookCallError(str(error)) from None
    except httpx.HTTPError as error:
        raise WebhookCallError(f"no connection: {type(error).__name__}") from None
    if not httpx.codes.is_success(status):
        raise WebhookCallError(f"it answered {status}")


def signature(secret: str, timestamp: int, body: bytes) -> str:
    """Return HMAC-SHA256 of `timestamp`, a dot and the body, as the header has it."""
    signed = hmac.new(secret.encode(), f"{timestamp}.".encode() + body, hashlib.sha256)
    return f"sha256={signed.hexdigest()}"


async def _status(client: httpx.AsyncClient, request: httpx.Request) -> int:
    response = await client.send(request, stream=True)
    await response.aclose()
    return response.status_code


def _request(
    client: httpx.AsyncClient, target: WebhookUrl, address: str, call: WebhookCall, timestamp: int
) -> httpx.Request:
    """Make the request to the address that was checked, under the host's name."""
    path, _, query = target.path.partition("?")
    url = urlunsplit((target.scheme, _authority(address, target.port), path, query, ""))
    headers = {
        "Host": _authority(target.host, target.port),
        "Content-Type": "application/json",
        "User-Agent": "rtron",
        TIMESTAMP_HEADER: str(timestamp),
        SIGNATURE_HEADER: signature(call.secret, timestamp, call.body),
    }
    extensions = {"sni_hostname": target.host}
    return client.build_request(
        "POST", url, content=call.body, headers=headers, extensions=extensions
    )


def _authority(host: str, port: int) -> str:
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


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
