"""How many connections there may be, of an address and of all, and which has to go."""

from collections import Counter
from collections.abc import Callable, Sequence
from ipaddress import ip_network

from rtron.service.domain.client_address import is_trusted, is_within, network_prefix

MAX_PER_ADDRESS = 100
"""The most connections of one address that have not become WebSockets."""


MAX_PER_TRUSTED_ADDRESS = 500
"""Those of this machine, and of a reverse proxy."""


MAX_CONNECTIONS = 2000
"""The most connections of all addresses that have not become WebSockets."""


class ConnectionLimit:
    """Counts connections by address, of IPv6 by the /64; used in the event loop.

    Where there are too many of all addresses, the one that has waited longest for its client has to
    go: for a request, for more of it, or until an answer is read. So those that are silent or slow
    keep nobody out. Guards are no part of it: they have become WebSockets.
    """

    def __init__(self, proxies: Sequence[str], max_connections: int = MAX_CONNECTIONS) -> None:
        self._proxies = tuple(ip_network(proxy, strict=False) for proxy in proxies)
        self._counts: Counter[str] = Counter()
        self._max_connections = max_connections
        self._waiting: dict[object, Callable[[], None]] = {}

    def is_proxy(self, address: str) -> bool:
        """Tell whether an address is one of the reverse proxies; this machine is one if named."""
        return is_within(address, self._proxies)

    def acquire(self, address: str) -> bool:
        """Count a connection, unless there are too many already."""
        key = network_prefix(address)
        if self._counts[key] >= (
            MAX_PER_TRUSTED_ADDRESS if is_trusted(address, self._proxies) else MAX_PER_ADDRESS
        ):
            return False
        if self._counts.total() >= self._max_connections and not self._abort_waiting():
            return False
        self._counts[key] += 1
        return True

    def add_waiting(self, connection: object, abort: Callable[[], None]) -> None:
        """Note that a connection waits for its client; `abort` ends it and releases its address."""
        self._waiting[connection] = abort

    def remove_waiting(self, connection: object) -> None:
        """Note that a connection waits no more, or is over."""
        self._waiting.pop(connection, None)

    def _abort_waiting(self) -> bool:
        """End the connection that has waited longest; tell whether there was one."""
        connection = next(iter(self._waiting), None)
        if connection is not None:
            self._waiting.pop(connection)()
        return connection is not None

    def release(self, address: str) -> None:
        """Count a connection no more."""
        key = network_prefix(address)
        self._counts[key] -= 1
        if not self._counts[key]:
            del self._counts[key]
