"""How many connections each address holds: a stranger must not have all of them."""

from collections import Counter
from collections.abc import Sequence
from ipaddress import ip_address, ip_network

from rtron.service.domain.login_throttle import network

MOST = 100
"""The most connections of one address that have not become WebSockets."""
MOST_NEAR = 500
"""Those of this machine, and of a reverse proxy."""


class Crowd:
    """Counts connections by address, of IPv6 by the /64; used in the event loop."""

    def __init__(self, proxies: Sequence[str]) -> None:
        self._proxies = tuple(ip_network(proxy, strict=False) for proxy in proxies)
        self._counts: Counter[str] = Counter()

    def enter(self, address: str) -> bool:
        """Count a connection, unless there are too many already."""
        key = network(address)
        if self._counts[key] >= (MOST_NEAR if self._is_near(address) else MOST):
            return False
        self._counts[key] += 1
        return True

    def leave(self, address: str) -> None:
        """Count a connection no more."""
        key = network(address)
        self._counts[key] -= 1
        if not self._counts[key]:
            del self._counts[key]

    def _is_near(self, address: str) -> bool:
        try:
            parsed = ip_address(address.partition("%")[0])
        except ValueError:
            return True
        parsed = getattr(parsed, "ipv4_mapped", None) or parsed
        return parsed.is_loopback or any(parsed in proxy for proxy in self._proxies)
