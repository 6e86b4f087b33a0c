"""How often codes of a second factor may be tried: after five failures each waits longer."""

from collections import OrderedDict
from dataclasses import dataclass
from threading import Lock

from rtron.vocabulary import SECOND

_MAX_KEYS = 10_000
_FREE_FAILURES = 5
_MAX_DELAY = 3600 * SECOND
_FORGET_CODES_AFTER = 24 * 3600 * SECOND


@dataclass(slots=True)
class _WrongCodes:
    count: int = 0
    last: int = 0

    def delay(self, now: int) -> int:
        doublings = min(self.count - _FREE_FAILURES, 20)
        return (
            0 if doublings < 0 else max(0, self.last + min(SECOND << doublings, _MAX_DELAY) - now)
        )


class CodeThrottle:
    """The failures of users' codes; bounded, thread-safe, `now` in ns."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._failures: OrderedDict[tuple[str, str], _WrongCodes] = OrderedDict()

    def begin_attempt(self, name: str, known_origin: str, now: int) -> int:
        """Count an attempt as failed before it is judged; return how long to wait instead, ns.

        `known_origin` is from where the user has logged in before; "" for any other place.
        """
        with self._lock:
            failures = self._recent(name, known_origin, now)
            delay = failures.delay(now)
            if not delay:
                failures.count, failures.last = failures.count + 1, now
            return delay

    def count_attempt(self, name: str, known_origin: str, now: int) -> None:
        """Count an attempt as failed that another process has let in."""
        with self._lock:
            failures = self._recent(name, known_origin, now)
            failures.count, failures.last = failures.count + 1, now

    def record_success(self, name: str, known_origin: str) -> None:
        """Forget what failed there: the code was right."""
        with self._lock:
            self._failures.pop((name, known_origin), None)

    def _recent(self, name: str, known_origin: str, now: int) -> _WrongCodes:
        key = name, known_origin
        failures = self._failures.setdefault(key, _WrongCodes())
        self._failures.move_to_end(key)
        if len(self._failures) > _MAX_KEYS:
            self._failures.popitem(last=False)
        if now - failures.last > _FORGET_CODES_AFTER:
            failures.count = 0
        return failures
