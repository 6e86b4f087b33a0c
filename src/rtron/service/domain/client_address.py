"""Addresses of clients: which of them count as one, and which are trusted."""

from collections.abc import Iterable
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address
from typing import TypeAlias

IpNetwork: TypeAlias = IPv4Network | IPv6Network


def network_prefix(address: str) -> str:
    """Return the address; of IPv6 its /64, since one client can have all addresses of that."""
    parsed = _parse(address)
    if isinstance(parsed, IPv6Address):
        return str(IPv6Address(int(parsed) >> 64 << 64))
    return str(parsed) if parsed else address


def is_trusted(address: str, proxies: Iterable[IpNetwork]) -> bool:
    """Tell whether an address is of this machine, a local socket's, or one of the proxies."""
    parsed = _parse(address)
    return parsed is None or parsed.is_loopback or any(parsed in proxy for proxy in proxies)


def _parse(address: str) -> IPv4Address | IPv6Address | None:
    """Return an address without its zone, of an IPv4 in IPv6 the IPv4; None if it is none."""
    try:
        parsed = ip_address(address.partition("%")[0])
    except ValueError:
        return None
    return getattr(parsed, "ipv4_mapped", None) or parsed
