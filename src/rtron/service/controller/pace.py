"""How often a guard's hello may change what is stored."""

from collections import deque

from rtron.errors import InputError
from rtron.vocabulary import SECOND

MAX_HELLOS_PER_MINUTE = 10
"""The most hellos of one robot within a minute that change its app, its plan or its settings."""
_MINUTE = 60 * SECOND


class HelloRateLimit:
    """Counts such hellos of each robot; not for several threads at once."""

    def __init__(self) -> None:
        self._times: dict[str, deque[int]] = {}

    def count(self, robot: str, now: int) -> None:
        """Count one at `now` (ns, wall clock); InputError if there were too many."""
        times = self._times.setdefault(robot, deque(maxlen=MAX_HELLOS_PER_MINUTE))
        if len(times) == MAX_HELLOS_PER_MINUTE and abs(now - times[0]) < _MINUTE:
            message = f"more than {MAX_HELLOS_PER_MINUTE} hellos within a minute that change the app or the plan"
            raise InputError(message, help="do several guards have this robot's token?")
        times.append(now)
