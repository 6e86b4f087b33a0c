"""Results of goals that are over, kept for a while: a client may ask only when it hears the end."""

from collections import OrderedDict
from dataclasses import dataclass

from rtron.vocabulary import SECOND

KEPT_FOR = 10 * SECOND
"""As long as rcl_action's servers keep them."""
MOST_KEPT = 256


@dataclass(frozen=True, slots=True)
class Result:
    """How a goal of a client has ended; no result is an empty one."""

    client: str
    flow: str
    stamp: int
    status: int
    result: object | None
    until: int


class Results:
    """The newest results by the goal's id."""

    def __init__(self) -> None:
        self._kept: OrderedDict[bytes, Result] = OrderedDict()

    def keep(self, id: bytes, result: Result) -> None:
        """Keep a result until its time."""
        self._kept[id] = result
        if len(self._kept) > MOST_KEPT:
            self._kept.popitem(last=False)

    def flow(self, id: bytes) -> str:
        """Return the flow of a goal that is over, or nothing."""
        found = self._kept.get(id)
        return found.flow if found else ""

    def find(self, id: bytes, client: str, now: int) -> Result | None:
        """Return the result of a client's goal; what has been kept long enough is forgotten."""
        while self._kept and next(iter(self._kept.values())).until <= now:
            self._kept.popitem(last=False)
        found = self._kept.get(id)
        return found if found and found.client == client else None
