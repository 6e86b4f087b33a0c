"""How often logins may be tried: each failure makes the next attempt wait longer.

An address that fails waits for itself. A name that fails from many addresses makes those wait that
have failed before, never one that has not: so nobody can lock somebody else out from afar.
"""

from collections import OrderedDict
from dataclasses import dataclass
from threading import Lock

from rtron.service.domain.client_address import network_prefix
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
    """The failures of late, by address and by name; bounded, thread-safe, `now` in ns."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._addresses: OrderedDict[str, _Failures] = OrderedDict()
        self._names: OrderedDict[str, _Failures] = OrderedDict()
        self.failed_count = 0

    def begin_attempt(self, name: str, address: str, now: int) -> int:
        """Count an attempt as failed before it is judged; return how long to wait instead, ns.

        Counted first, since many attempts at once must not pass for one.
        """
        with self._lock:
            by_address = _recent_failures(
                self._addresses, network_prefix(address), now, ADDRESS_BACKOFF
            )
            by_name = _recent_failures(self._names, name, now, NAME_BACKOFF)
            delay = _remaining_delay(by_address, ADDRESS_BACKOFF, now)
            if by_address.count:
                delay = max(delay, _remaining_delay(by_name, NAME_BACKOFF, now))
            if not delay:
                for failures in (by_address, by_name):
                    failures.count, failures.last = failures.count + 1, now
                self.failed_count += 1
            return delay

    def cancel_attempt(self, name: str, address: str) -> None:
        """Take back an attempt that nobody has judged; the failures before it stay."""
        with self._lock:
            for table, key in ((self._names, name), (self._addresses, network_prefix(address))):
                if failures := table.get(key):
                    failures.count = max(0, failures.count - 1)
            self.failed_count -= 1

    def record_success(self, name: str, address: str) -> None:
        """Take back an attempt; the failures before it stay those of the address."""
        with self._lock:
            self._names.pop(name, None)
            if by_address := self._addresses.get(network_prefix(address)):
                by_address.count = max(0, by_address.count - 1)
            self.failed_count -= 1


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
