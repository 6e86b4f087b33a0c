"""How often logins may be tried: each failure makes the next attempt wait longer.

An address that fails waits for itself. A name that fails from many addresses makes those wait that
have failed before, never one that has not: so nobody can lock somebody else out from afar.
"""

from collections import OrderedDict
from dataclasses import dataclass
from ipaddress import IPv6Address, ip_address
from threading import Lock

SECOND = 1_000_000_000
_MOST = 10_000
_FORGOTTEN_AFTER = 3600 * SECOND
_FEW_FORGOTTEN_AFTER = 60 * SECOND


@dataclass(slots=True)
class _Failures:
    count: int = 0
    last: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Patience:
    """So many failures are `free`; then the wait doubles from a second to `longest` (ns)."""

    free: int
    longest: int

    def after(self, failures: int) -> int:
        """Return how long the next attempt waits after so many failures, ns."""
        doublings = min(failures - self.free, 60)
        return 0 if doublings < 0 else min(SECOND << doublings, self.longest)


ADDRESS = Patience(free=5, longest=900 * SECOND)
NAME = Patience(free=10, longest=60 * SECOND)


class Attempts:
    """The failures of late, by address and by name; bounded, thread-safe, `now` in ns."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._addresses: OrderedDict[str, _Failures] = OrderedDict()
        self._names: OrderedDict[str, _Failures] = OrderedDict()
        self.failed = 0

    def begin(self, name: str, address: str, now: int) -> int:
        """Count an attempt as failed before it is judged; return how long to wait instead, ns.

        Counted first, since many attempts at once must not pass for one.
        """
        with self._lock:
            by_address = _recent(self._addresses, network(address), now, ADDRESS)
            by_name = _recent(self._names, name, now, NAME)
            wait = _left(by_address, ADDRESS, now)
            if by_address.count:
                wait = max(wait, _left(by_name, NAME, now))
            if not wait:
                for each in (by_address, by_name):
                    each.count, each.last = each.count + 1, now
                self.failed += 1
            return wait

    def take_back(self, name: str, address: str) -> None:
        """Take back an attempt that nobody has judged; the failures before it stay."""
        with self._lock:
            for known, key in ((self._names, name), (self._addresses, network(address))):
                if failures := known.get(key):
                    failures.count = max(0, failures.count - 1)
            self.failed -= 1

    def succeeded(self, name: str, address: str) -> None:
        """Take back an attempt; the failures before it stay those of the address."""
        with self._lock:
            self._names.pop(name, None)
            if by_address := self._addresses.get(network(address)):
                by_address.count = max(0, by_address.count - 1)
            self.failed -= 1


def network(address: str) -> str:
    """Return the address, of IPv6 the /64: who has one address there has all of them."""
    try:
        parsed = ip_address(address.partition("%")[0])
    except ValueError:
        return address
    if isinstance(parsed, IPv6Address):
        inner = parsed.ipv4_mapped
        return str(inner) if inner else str(IPv6Address(int(parsed) >> 64 << 64))
    return str(parsed)


def _recent(
    known: OrderedDict[str, _Failures], key: str, now: int, patience: Patience
) -> _Failures:
    """Return what is known of a key, nothing if that was long ago; drop the one unused longest."""
    failures = known.setdefault(key, _Failures())
    known.move_to_end(key)
    if len(known) > _MOST:
        known.popitem(last=False)
    few = failures.count < patience.free
    if now - failures.last > (_FEW_FORGOTTEN_AFTER if few else _FORGOTTEN_AFTER):
        failures.count = 0
    return failures


def _left(failures: _Failures, patience: Patience, now: int) -> int:
    return max(0, failures.last + patience.after(failures.count) - now)
