"""The same alarm again is no news."""

from collections import OrderedDict
from collections.abc import Mapping
from typing import Any

_MOST = 10_000
_KEY = ("robot", "kind", "level", "node", "topic", "flow", "publisher", "decision")


class Repeats:
    """Tells events that were told within `within` (ns) of late; bounded, time passed in."""

    def __init__(self, within: int = 60_000_000_000) -> None:
        self._within = within
        self._told: OrderedDict[tuple[Any, ...], int] = OrderedDict()

    def is_one(self, event: Mapping[str, Any], now: int) -> bool:
        """Tell whether an event like this was told of late; if not, it is told now."""
        key = tuple(event.get(name) for name in _KEY)
        told = self._told.get(key)
        if told is not None and now - told < self._within:
            return True
        self._told[key] = now
        self._told.move_to_end(key)
        if len(self._told) > _MOST:
            self._told.popitem(last=False)
        return False
