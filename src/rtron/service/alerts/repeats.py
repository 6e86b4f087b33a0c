"""The same alarm again is no news."""

from collections import OrderedDict
from collections.abc import Mapping
from typing import Any

_MAX_ALARMS = 10_000
_KEY = ("robot", "kind", "level", "node", "topic", "flow", "publisher", "decision")


class DuplicateFilter:
    """Tells events that were told within `window` (ns) of late; bounded, time passed in."""

    def __init__(self, window: int = 60_000_000_000) -> None:
        self._window = window
        self._reported_at: OrderedDict[tuple[Any, ...], int] = OrderedDict()

    def is_duplicate(self, event: Mapping[str, Any], now: int) -> bool:
        """Tell whether an event like this was told of late; if not, it is told now."""
        key = tuple(event.get(name) for name in _KEY)
        reported_at = self._reported_at.get(key)
        if reported_at is not None and now - reported_at < self._window:
            return True
        self._reported_at[key] = now
        self._reported_at.move_to_end(key)
        if len(self._reported_at) > _MAX_ALARMS:
            self._reported_at.popitem(last=False)
        return False
