"""What one guard is told of its events: up to which number they are safe, or to send them again.

`Stored` speaks of all events of a run up to a number. So once events are refused, because they
cannot be stored now, later ones of that run are refused too, until they come again in order; and of
what was on its way then nothing is confirmed, before it comes again.

    the link sends      1 2   3 4   5 6                     3 4 5   6
    the service stores  yes   no    yes, or is not asked    yes     yes
    and answers         2     refused                       5       6
"""

from collections.abc import Iterator, Sequence

from rtron.vocabulary import GuardEvent
from rtron.wire.common.link_protocol import EventsRefused, Stored


class EventReceipts:
    """The receipts of one connection that are still to be sent."""

    def __init__(self) -> None:
        self._stored: dict[str, int] = {}
        self._refused: dict[str, int] = {}
        self._has_refusal = False
        self._refusals = 0

    def accept(self, events: Sequence[GuardEvent]) -> int | None:
        """Return a number to confirm these events with; None if they leave out refused ones."""
        first = {event.run: event.number for event in reversed(events)}
        if any(number > self._refused.get(run, number) for run, number in first.items()):
            self._note_refused(events)
            return None
        for run in first:
            self._refused.pop(run, None)
        return self._refusals

    def refuse(self, events: Sequence[GuardEvent]) -> None:
        """Note that events are not stored, and have to come again."""
        self._note_refused(events)
        self._refusals += 1
        self._has_refusal = True

    def confirm(self, events: Sequence[GuardEvent], number: int) -> None:
        """Note that events are stored that were accepted with a number."""
        if number == self._refusals:
            for event in events:
                self._stored[event.run] = max(event.number, self._stored.get(event.run, 0))

    def take(self) -> Iterator[Stored | EventsRefused]:
        """Yield what is to be sent now."""
        while self._stored:
            run, number = self._stored.popitem()
            yield Stored(run=run, number=number)
        if self._has_refusal:
            self._has_refusal = False
            yield EventsRefused()

    def _note_refused(self, events: Sequence[GuardEvent]) -> None:
        for event in events:
            self._refused[event.run] = min(event.number, self._refused.get(event.run, event.number))
