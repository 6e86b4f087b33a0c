"""Rounds of questions: everybody is asked once a period, evenly spread, and nobody is waited for.

Half of them are asked in one go, and their answers looked for in one go, not when each arrives: a
loop that is woken by every answer of forty nodes needs twice as much of the processor.
"""

from collections.abc import Callable
from dataclasses import dataclass

from rtron.errors import RTronError
from rtron.guard.audit.ros1.xmlrpc_poller import Asker, Place
from rtron.guard.core.event_loop import Loop
from rtron.vocabulary import SECOND

TURNS = 2
"""How many turns a round has."""
_LATE = SECOND
_PARTS = 5
"""How often a turn may look for answers, the asking included."""


@dataclass(slots=True, kw_only=True, eq=False)
class Asked:
    """Whom to ask, and who takes the answer.

    Nobody is asked while `place` is not known, nor before `not_before` (ns).
    """

    asker: Asker
    answered: Callable[[bytes], None]
    failed: Callable[[Exception], None]
    place: Place | None = None
    not_before: int = 0


class Rounds:
    """Asks everybody once in `period` (ns); an answer that takes longer than 1 s is none."""

    def __init__(self, loop: Loop, period: int) -> None:
        self._loop = loop
        self._step = max(1, period // TURNS)
        self._turns: list[list[Asked]] = [[] for _ in range(TURNS)]
        self._turn = 0
        self._waiting: list[Asked] = []
        self._due = 0
        self._looks = 0
        self._closed = False

    def start(self) -> None:
        """Ask from now on."""
        self._due = self._loop.now()
        self._tick()

    def add(self, asked: Asked) -> None:
        """Ask one more."""
        min(self._turns, key=len).append(asked)

    def remove(self, asked: Asked) -> None:
        """Ask one no more."""
        for group in (*self._turns, self._waiting):
            if asked in group:
                group.remove(asked)
        asked.asker.close()

    def close(self) -> None:
        """Ask nobody any more."""
        self._closed = True
        for asked in [each for turn in self._turns for each in turn]:
            self.remove(asked)

    def _tick(self) -> None:
        if self._closed:
            return
        now = self._loop.now()
        self._due = max(self._due + self._step, now)
        self._loop.call_at(self._due, self._tick)
        self._turn = (self._turn + 1) % TURNS
        self._look(now)
        for asked in list(self._turns[self._turn]):
            self._ask(asked, now)
        self._looks = 0
        self._loop.call_at(now + self._step // _PARTS, self._look_soon)

    def _look_soon(self) -> None:
        """Look for answers, and for the late ones a little later."""
        if self._closed:
            return
        now = self._loop.now()
        self._look(now)
        self._looks += 1
        if self._waiting and self._looks < _PARTS - 1:
            self._loop.call_at(now + self._step // _PARTS, self._look_soon)

    def _look(self, now: int) -> None:
        waiting, self._waiting = self._waiting, []
        self._waiting += [asked for asked in waiting if not self._looked(asked, now)]

    def _ask(self, asked: Asked, now: int) -> None:
        if asked.place is None or asked.asker.since or now < asked.not_before:
            return
        try:
            asked.asker.ask(asked.place, now)
        except (OSError, RTronError) as error:
            asked.asker.close()
            asked.failed(error)
        else:
            self._waiting.append(asked)

    def _looked(self, asked: Asked, now: int) -> bool:
        """Look whether an answer is there; tell whether there is nothing more to look for."""
        since = asked.asker.since
        try:
            body = asked.asker.poll()
        except (OSError, RTronError) as error:
            asked.failed(error)
            return True
        if body is not None:
            asked.answered(body)
        elif since and now - since > _LATE:
            asked.asker.close()
            asked.failed(TimeoutError("no answer within 1 s"))
            return True
        return body is not None or not since
