"""The alarms that stand with the streams that they brake, settled when what they tell is over."""

from collections.abc import Iterable

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.vocabulary import Alarm


class BrakingAlarms:
    """Raises what is found at each look, and settles what is found no more."""

    def __init__(self, response: AlarmResponse) -> None:
        self._response = response
        self._active: dict[Alarm, tuple[str, ...]] = {}

    def update(self, alarms: Iterable[tuple[Alarm, tuple[str, ...]]], now: int) -> None:
        """Take all that is wrong at `now`, each with the public names of what it brakes."""
        active = dict(alarms)
        before, self._active = self._active, active
        for alarm, guarded in active.items():
            if before.get(alarm) != guarded:
                self._response.raise_(alarm, now, *guarded)
        for alarm in before.keys() - active.keys():
            self._response.settle(alarm)
