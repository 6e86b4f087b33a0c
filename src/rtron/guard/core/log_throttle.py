"""Saying the same thing once a second at most, so that a flood of events is none of log lines."""

from collections.abc import Hashable

from rtron.vocabulary import SECOND

PERIOD = SECOND


class Seldom:
    """Tells whether it is time to say something again."""

    def __init__(self) -> None:
        self._said: dict[Hashable, int] = {}

    def may_say(self, what: Hashable, now: int) -> bool:
        """Tell whether `what` was not said within the last second, and take it as said."""
        said = self._said.get(what)
        if said is not None and now - said < PERIOD:
            return False
        self._said[what] = now
        return True
