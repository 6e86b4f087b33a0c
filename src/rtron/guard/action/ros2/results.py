"""Results of goals that are over, kept for a while: a client may ask only when it hears the end."""

from collections import OrderedDict
from dataclasses import dataclass

from rtron.vocabulary import SECOND

RESULT_TIMEOUT = 10 * SECOND
"""As long as rcl_action's servers keep them."""
MAX_RESULTS = 256


@dataclass(frozen=True, slots=True)
class GoalResult:
    """How a goal of a client has ended; no result is an empty one."""

    client: str
    flow: str
    stamp: int
    status: int
    result: object | None
    expires_at: int


class ResultCache:
    """The newest results by the goal's id."""

    def __init__(self) -> None:
        self._results: OrderedDict[bytes, GoalResult] = OrderedDict()

    def add(self, id: bytes, result: GoalResult) -> None:
        """Keep a result until its time."""
        self._results[id] = result
        if len(self._results) > MAX_RESULTS:
            self._results.popitem(last=False)

    def flow_of(self, id: bytes) -> str:
        """Return the flow of a goal that is over, or nothing."""
        result = self._results.get(id)
        return result.flow if result else ""

    def find(self, id: bytes, client: str, now: int) -> GoalResult | None:
        """Return the result of a client's goal; what has been kept long enough is forgotten."""
        while self._results and next(iter(self._results.values())).expires_at <= now:
            self._results.popitem(last=False)
        result = self._results.get(id)
        return result if result and result.client == client else None
