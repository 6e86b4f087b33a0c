"""What the supervisor does about the guard, whatever happens to it; sans-I/O.

A guard that stands still stops the robot at once and loses its life only much later: a stall ends
with the next beat, a restart takes a while.
"""

import os
from dataclasses import dataclass
from enum import Enum

from rtron.vocabulary import SECOND

STALLED = 55 * SECOND // 1000
"""Silence after which the robot is stopped, ns: a few beats more than a busy machine delays."""
HUNG = SECOND
"""Silence after which the guard is killed, ns."""
STARTING = 20 * SECOND
"""How long a guard may take until its topics are open, ns."""
BEGINNING = 2 * SECOND
"""The same for a guard that had started up before and only waited to begin, ns."""
ENDING = 8 * SECOND
"""How long a guard may take to end in order, ns."""
LOST = SECOND // 2
"""How long a guard may still be there when its connection has ended, ns."""
_LONG_ENOUGH = 2 * SECOND
_FIRST_DELAY = SECOND // 4
_LONGEST_DELAY = 10 * SECOND

OK, REFUSED = 0, 2
STARVED = os.EX_OSERR
"""The exit code of a guard that has run out of memory."""
TAKEN = os.EX_UNAVAILABLE
"""The exit code of a guard that has found another one on its master."""


class Phase(Enum):
    """How the guard is."""

    WAITING = "there is none; one is started when it is due"
    STARTING = "it is starting"
    SERVING = "it guards"
    STALLED = "it stands still"
    KILLED = "it was told to die"
    LOST = "it is dead, or as good as"
    OVER = "it ended, and so does the supervisor"


class Act(Enum):
    """What is to be done."""

    SPAWN = "start a guard"
    BRAKE = "stop the robot, and keep it stopped"
    LOOSEN = "let the stop come to its end: the guard is there"
    TERMINATE = "tell the guard to end"
    KILL = "kill the guard"
    LEAVE = "end the supervisor too"


@dataclass(frozen=True, slots=True)
class Sign:
    """What is seen of the guard: how long it has not beaten (ns), and what it says of itself."""

    silent: int
    serving: bool
    leaving: bool = False


class Keeper:
    """Turns what is seen into what is to be done; `code` is what the supervisor ends with."""

    def __init__(self, now: int, *, adopted: bool = False) -> None:
        self.phase = Phase.SERVING if adopted else Phase.WAITING
        self.code = OK
        self._since = now
        self._due = now
        self._served = now if adopted else None
        self._ever = adopted
        self._failures = 0
        self._ends = False
        self._patience = STARTING

    def look(self, now: int, sign: Sign) -> tuple[Act, ...]:
        """Look at the guard, every few milliseconds."""
        match self.phase:
            case Phase.WAITING:
                return self._wait(now)
            case Phase.STARTING:
                return self._start(now, sign)
            case Phase.SERVING | Phase.STALLED:
                return self._watch(now, sign)
            case Phase.LOST if now - self._since > LOST:
                self._since = now
                return (Act.KILL,)
            case _:
                return ()

    def lost(self, now: int) -> tuple[Act, ...]:
        """Take note that the connection to the guard has ended: it is dead, or will be."""
        if self.phase in (Phase.LOST, Phase.OVER, Phase.WAITING):
            return ()
        self.phase, self._since = Phase.LOST, now
        return (Act.BRAKE,) if self._ever else ()

    def ready(self) -> None:
        """Take note that the guard which begins was ready, and needs little time."""
        self._patience = BEGINNING

    def failed(self, now: int) -> None:
        """Take note that no guard could be started: another attempt is due later."""
        self._await_next(now)

    def ended(self, now: int, code: int) -> tuple[Act, ...]:
        """Take note of the guard's exit code, minus the signal if one has killed it."""
        refused = code == TAKEN or (code == REFUSED and not self._ever)
        if self._ends or refused or code == OK:
            return self._leave(REFUSED if refused and not self._ends else OK)
        self._await_next(now)
        return ()

    def end(self, now: int) -> tuple[Act, ...]:
        """End: the guard first."""
        if self._ends or self.phase is Phase.OVER:
            return ()
        self._ends, self._since = True, now
        if self.phase is Phase.WAITING:
            return self._leave(OK)
        return (Act.TERMINATE,)

    def dismiss(self) -> tuple[Act, ...]:
        """Leave the guard to another supervisor."""
        return self._leave(OK)

    @property
    def due(self) -> int:
        """When the next guard is started, ns."""
        return self._due

    def _wait(self, now: int) -> tuple[Act, ...]:
        if now < self._due:
            return ()
        self.phase, self._since, self._patience = Phase.STARTING, now, STARTING
        return (Act.SPAWN,)

    def _start(self, now: int, sign: Sign) -> tuple[Act, ...]:
        if self._overdue(now) or now - self._since > self._patience:
            return self._kill()
        if not sign.serving:
            return ()
        self.phase, self._served, self._ever = Phase.SERVING, now, True
        return (Act.LOOSEN,)

    def _watch(self, now: int, sign: Sign) -> tuple[Act, ...]:
        if sign.leaving and not self._ends:
            self._ends, self._since = True, now
        if self._overdue(now) or (sign.silent >= HUNG and not sign.leaving):
            return self._kill()
        stalled = sign.leaving or sign.silent >= STALLED
        if stalled == (self.phase is Phase.STALLED):
            return ()
        self.phase = Phase.STALLED if stalled else Phase.SERVING
        return (Act.BRAKE,) if stalled else (Act.LOOSEN,)

    def _overdue(self, now: int) -> bool:
        return self._ends and now - self._since > ENDING

    def _kill(self) -> tuple[Act, ...]:
        self.phase = Phase.KILLED
        return (Act.KILL,)

    def _leave(self, code: int) -> tuple[Act, ...]:
        self.phase, self.code = Phase.OVER, code
        return (Act.LEAVE,)

    def _await_next(self, now: int) -> None:
        self._due = now + self._delay(now)
        self._served = None
        self.phase = Phase.WAITING

    def _delay(self, now: int) -> int:
        """Return how long to wait: not at all after a guard that served, ever longer otherwise."""
        if self._served is not None and now - self._served >= _LONG_ENOUGH:
            self._failures = 0
            return 0
        self._failures += 1
        return int(min(_FIRST_DELAY << min(self._failures - 1, 10), _LONGEST_DELAY))
