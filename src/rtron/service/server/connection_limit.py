"""How many connections each address holds: a stranger must not have all of them."""

from collections import Counter
from collections.abc import Sequence
from ipaddress import ip_address, ip_network

from rtron.service.domain.login_throttle import network_prefix

MAX_PER_ADDRESS = 100
"""The most connections of one address that have not become WebSockets."""
MAX_PER_TRUSTED_ADDRESS = 500
"""Those of this machine, and of a reverse proxy."""


class ConnectionLimit:
    """Counts connections by address, of IPv6 by the /64; used in the event loop."""

    def __init__(self, proxies: Sequence[str]) -> None:
        self._proxies = tuple(ip_network(proxy, strict=False) for proxy in proxies)
        self._counts: Counter[str] = Counter()

    def acquire(self, address: str) -> bool:
        """Count a connection, unless there are too many already."""
        key = network_prefix(address)
        if self._counts[key] >= (
            MAX_PER_TRUSTED_ADDRESS if self._is_trusted(address) else MAX_PER_ADDRESS
        ):
            return False
        self._counts[key] += 1
        return True

    def release(self, address: str) -> None:
        """Count a connection no more."""
        key = network_prefix(address)
        self._counts[key] -= 1
        if not self._counts[key]:
            del self._counts[key]

    def _is_trusted(self, address: str) -> bool:
        try:
            parsed = ip_address(address.partition("%")[0])
        except ValueError:
            return True
        parsed = getattr(parsed, "ipv4_mapped", None) or parsed
        return parsed.is_loopback or any(parsed in proxy for proxy in self._proxies)
