"""Messages of one stream that were lost without a verdict: before the guard, and behind it."""

import logging
from collections.abc import Mapping

from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

PERIOD = 10 * SECOND


class Losses:
    """Counts what is lost of each flow before the guard, and logs what is lost on both sides."""

    def __init__(self, topic: str) -> None:
        self.before: dict[str, int] = {}
        """How many messages of each flow did not reach the guard, or too late."""
        self.topic = topic
        self._known: Mapping[str, int] = {}
        self._changed_at: int | None = None
        self._logged: Mapping[str, int] = {}
        self._logged_at: int | None = None

    def count(self, flow: str, number: int) -> None:
        """Count messages of a flow that were lost before one that arrived."""
        self.before[flow] = self.before.get(flow, 0) + number

    def update(self, behind: Mapping[str, int], now: int) -> None:
        """Log what was lost since the last log line, at most every 10 s.

        `behind` is what was lost until now of each topic that the guard publishes.
        """
        lost = {f"of {flow}, before the guard": n for flow, n in self.before.items()}
        lost |= {f"on {topic}, behind the guard": n for topic, n in behind.items()}
        if lost != self._known:
            self._known, self._changed_at = lost, now
        if lost != self._logged and (self._logged_at is None or now - self._logged_at >= PERIOD):
            news = {where: n - self._logged.get(where, 0) for where, n in lost.items()}
            text = "; ".join(f"{n} {where}" for where, n in news.items() if n)
            log.warning("%s: messages were lost: %s", self.topic, text)
            self._logged, self._logged_at = lost, now

    def are_recent(self, now: int) -> bool:
        """Tell whether some were lost within the last 10 s, as far as `update` was told."""
        return self._changed_at is not None and now - self._changed_at < PERIOD
