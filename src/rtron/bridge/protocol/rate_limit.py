"""How often something may happen: token buckets, with the time passed in."""

from dataclasses import dataclass

from rtron.vocabulary import SECOND


@dataclass(slots=True)
class TokenBucket:
    """Lets `rate` a second pass, and up to `burst` at once (the leaky bucket as a meter, I.371)."""

    rate: float
    burst: float
    _level: float = 0.0
    _updated: int = 0

    def take(self, now: int, count: float = 1.0) -> bool:
        """Take `count` at a time (ns); False, and nothing is taken, if so many do not fit."""
        elapsed = max(0, now - self._updated)
        level = max(0.0, self._level - elapsed * self.rate / SECOND)
        self._level, self._updated = level, max(now, self._updated)
        if level + count > self.burst:
            return False
        self._level = level + count
        return True


def message_bucket(rate: float) -> TokenBucket:
    """Return a bucket for messages of a rate: those of a fifth of a second may come together."""
    return TokenBucket(rate, max(1.0, rate / 5))


class ClientRates:
    """The buckets of one client, which outlast its connections: who comes again has the same."""

    def __init__(self) -> None:
        self._buckets: dict[str, TokenBucket] = {}

    def keep(self, what: str, bucket: TokenBucket) -> TokenBucket:
        """Return the bucket of what the client does: `bucket`, if there was none yet."""
        return self._buckets.setdefault(what, bucket)


class RefusalCounter:
    """How often a client was refused lately: each reason once a second, the others counted."""

    def __init__(self, period: int = SECOND, max_reasons: int = 32) -> None:
        self._period = period
        self._max_reasons = max_reasons
        self._reported: dict[str, tuple[int, int]] = {}

    def count(self, reason: str, now: int) -> int | None:
        """Count a refusal; return how often it was hushed before, None if it is not to be said."""
        since, hushed = self._reported.get(reason, (now - self._period, 0))
        if now - since < self._period:
            self._reported[reason] = since, hushed + 1
            return None
        self._forget(now)
        if len(self._reported) >= self._max_reasons:
            return None
        self._reported[reason] = now, 0
        return hushed

    def _forget(self, now: int) -> None:
        self._reported = {
            reason: (since, hushed)
            for reason, (since, hushed) in self._reported.items()
            if now - since < self._period
        }
