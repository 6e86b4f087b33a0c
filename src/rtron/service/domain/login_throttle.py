"""How often logins may be tried: each failure makes the next attempt wait longer.

An address that fails waits for itself. A name that fails from many addresses makes those wait that
have failed before, never one that has not, or from which that user has logged in before: so nobody
can lock somebody else out from afar. In a browser in which a user has logged in, only what fails
there counts; at an address from which the user has, only what fails there for that name: so nobody
can do it from nearby, behind the same address.

Where the user has logged in before, only what fails there counts; elsewhere, what fails anywhere: a
thief of the password with many addresses has no more guesses. Recovery codes are too long to be
guessed, so they never wait, and let the user in from everywhere.
"""

from collections import OrderedDict
from dataclasses import dataclass
from threading import Lock

from rtron.service.domain.client_address import network_prefix, wide_network
from rtron.vocabulary import SECOND

_MAX_KEYS = 10_000
_FORGET_AFTER = 3600 * SECOND
_FORGET_FEW_AFTER = 60 * SECOND


@dataclass(slots=True)
class _Failures:
    count: int = 0
    last: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Backoff:
    """After `free_failures` the wait doubles with each failure, from 1 s up to `max_delay` (ns)."""

    free_failures: int
    max_delay: int

    def delay_after(self, failures: int) -> int:
        """Return how long the next attempt waits after so many failures, ns."""
        doublings = min(failures - self.free_failures, 60)
        return 0 if doublings < 0 else min(SECOND << doublings, self.max_delay)


ADDRESS_BACKOFF = Backoff(free_failures=5, max_delay=900 * SECOND)
NAME_BACKOFF = Backoff(free_failures=10, max_delay=60 * SECOND)


class LoginThrottle:
    """The failures of late, by address and by name; bounded, thread-safe.

    `now` is of a monotonic clock, ns: nobody waits longer, or shorter, when the wall clock is set.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._addresses: OrderedDict[str, _Failures] = OrderedDict()
        self._networks: OrderedDict[str, _Failures] = OrderedDict()
        self._names: OrderedDict[str, _Failures] = OrderedDict()
        self._known: OrderedDict[tuple[str, str], None] = OrderedDict()
        self.failed_count = 0

    def add_known(self, name: str, address: str) -> None:
        """Note that a user has logged in from an address: guesses elsewhere delay nobody there."""
        with self._lock:
            key = name, network_prefix(address)
            self._known[key] = None
            self._known.move_to_end(key)
            if len(self._known) > _MAX_KEYS:
                self._known.popitem(last=False)

    def is_known(self, name: str, address: str) -> bool:
        """Tell whether a user has logged in from an address before."""
        with self._lock:
            return (name, network_prefix(address)) in self._known

    def rank(self, name: str, address: str, browser: str = "") -> int:
        """Return who is judged first: 0 where the user has logged in before, then by failures.

        Those of the whole network count too: who has a whole network has many addresses.
        """
        with self._lock:
            if browser or (name, network_prefix(address)) in self._known:
                return 0
            tables = (
                (self._addresses, network_prefix(address)),
                (self._networks, wide_network(address)),
            )
            found = (table.get(key) for table, key in tables)
            return 1 + sum(failures.count for failures in found if failures)

    def begin_attempt(self, name: str, address: str, now: int, browser: str = "") -> int:
        """Count an attempt as failed before it is judged; return how long to wait instead, ns.

        `browser` is one in which that user has logged in before. Counted first, since many
        attempts at once must not pass for one.
        """
        with self._lock:
            origin = self._origin(name, address, browser)
            by_origin = _recent_failures(self._addresses, origin, now, ADDRESS_BACKOFF)
            by_name = _recent_failures(self._names, name, now, NAME_BACKOFF)
            delay = _remaining_delay(by_origin, ADDRESS_BACKOFF, now)
            if by_origin.count and origin == network_prefix(address):
                delay = max(delay, _remaining_delay(by_name, NAME_BACKOFF, now))
            if not delay:
                self._count(name, address, origin, now)
            return delay

    def count_attempt(self, name: str, address: str, now: int, browser: str = "") -> None:
        """Count an attempt as failed that another process has let in."""
        with self._lock:
            self._count(name, address, self._origin(name, address, browser), now)

    def _count(self, name: str, address: str, origin: str, now: int) -> None:
        for failures in (
            _recent_failures(self._addresses, origin, now, ADDRESS_BACKOFF),
            _recent_failures(self._names, name, now, NAME_BACKOFF),
            _recent_failures(self._networks, wide_network(address), now, ADDRESS_BACKOFF),
        ):
            failures.count, failures.last = failures.count + 1, now
        self.failed_count += 1

    def _origin(self, name: str, address: str, browser: str) -> str:
        """Return what counts together: a known browser, a known address of a user, an address."""
        prefix = network_prefix(address)
        if browser:
            return f"browser {browser}"
        return f"{prefix} {name}" if (name, prefix) in self._known else prefix

    def cancel_attempt(self, name: str, address: str, browser: str = "") -> None:
        """Take back an attempt that nobody has judged, or that is only half of a login."""
        with self._lock:
            self._take_back(self._names, name)
            self._take_back(self._addresses, self._origin(name, address, browser))
            self._take_back(self._networks, wide_network(address))
            self.failed_count -= 1

    def record_success(self, name: str, address: str, browser: str = "") -> None:
        """Take back an attempt; the failures before it stay those of the address."""
        with self._lock:
            self._names.pop(name, None)
            self._take_back(self._addresses, self._origin(name, address, browser))
            self._take_back(self._networks, wide_network(address))
            self.failed_count -= 1
        self.add_known(name, address)

    def _take_back(self, table: OrderedDict[str, _Failures], key: str) -> None:
        if failures := table.get(key):
            failures.count = max(0, failures.count - 1)


def _recent_failures(
    table: OrderedDict[str, _Failures], key: str, now: int, backoff: Backoff
) -> _Failures:
    """Return what is known of a key, nothing if that was long ago; drop the one unused longest."""
    failures = table.setdefault(key, _Failures())
    table.move_to_end(key)
    if len(table) > _MAX_KEYS:
        table.popitem(last=False)
    few = failures.count < backoff.free_failures
    if now - failures.last > (_FORGET_FEW_AFTER if few else _FORGET_AFTER):
        failures.count = 0
    return failures


def _remaining_delay(failures: _Failures, backoff: Backoff, now: int) -> int:
    return max(0, failures.last + backoff.delay_after(failures.count) - now)
