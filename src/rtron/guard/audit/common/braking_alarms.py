"""The alarms that stand with the streams that they brake, settled when what they tell is over."""

from collections.abc import Iterable

from rtron.guard.audit.common.alarm_response import Response
from rtron.vocabulary import Alarm


class Cases:
    """Raises what is found at each look, and settles what is found no more."""

    def __init__(self, response: Response) -> None:
        self._response = response
        self._standing: dict[Alarm, tuple[str, ...]] = {}

    def found(self, cases: Iterable[tuple[Alarm, tuple[str, ...]]], now: int) -> None:
        """Take all that is wrong at `now`, each with the public names of what it brakes."""
        found = dict(cases)
        before, self._standing = self._standing, found
        for alarm, guarded in found.items():
            if before.get(alarm) != guarded:
                self._response.raise_(alarm, now, *guarded)
        for alarm in before.keys() - found.keys():
            self._response.settle(alarm)
