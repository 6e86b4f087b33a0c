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


def wide_network(address: str) -> str:
    """Return the network that one owner may have: of IPv6 the /48, of IPv4 the /24."""
    parsed = _parse(address)
    if parsed is None:
        return address
    bits = 80 if isinstance(parsed, IPv6Address) else 8
    return str(type(parsed)(int(parsed) >> bits << bits))


def is_loopback_name(name: str) -> bool:
    """Tell whether a host name or an address is this machine's own."""
    parsed = _parse(name)
    return parsed.is_loopback if parsed else name.lower() == "localhost"


def is_trusted(address: str, proxies: Iterable[IpNetwork]) -> bool:
    """Tell whether an address is of this machine, a local socket's, or one of the proxies."""
    parsed = _parse(address)
    return parsed is None or parsed.is_loopback or is_within(address, proxies)


def is_within(address: str, networks: Iterable[IpNetwork]) -> bool:
    """Tell whether an address is in one of the networks."""
    parsed = _parse(address)
    return parsed is not None and any(parsed in network for network in networks)


def _parse(address: str) -> IPv4Address | IPv6Address | None:
    """Return an address without its zone, of an IPv4 in IPv6 the IPv4; None if it is none."""
    try:
        parsed = ip_address(address.partition("%")[0])
    except ValueError:
        return None
    return getattr(parsed, "ipv4_mapped", None) or parsed
