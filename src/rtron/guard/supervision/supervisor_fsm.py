"""What the supervisor does about the guard, whatever happens to it; sans-I/O.

When the guard stalls, the supervisor stops the robot at once; it kills the guard later, since a
stall ends with the next beat and a restart takes a while. The plan has the bounds (`Supervision`).
"""

import os
from dataclasses import dataclass
from enum import Enum

from rtron.guard.supervision.watchdog import adapt_bound
from rtron.vocabulary import SECOND, Supervision
from rtron.vocabulary.plan import LONGEST_STALL

WARM_START_TIMEOUT = 2 * SECOND
"""The same for a guard that had started up before and only waited to begin, ns."""
END_TIMEOUT = 8 * SECOND
"""How long a guard may take to end in order, ns."""
LOST_TIMEOUT = SECOND // 2
"""How long a guard may still be there when its connection has ended, ns."""
USELESS_AFTER = 10
"""A guard that has delivered nothing for so many times its bound is killed: the next one may."""
_BACKOFF_RESET_AFTER = 2 * SECOND
_FIRST_DELAY = SECOND // 4
_MAX_DELAY = 10 * SECOND

OK, REFUSED = 0, 2
OUT_OF_MEMORY = os.EX_OSERR
"""The exit code of a guard that has run out of memory."""


class GuardPhase(Enum):
    """How the guard is."""

    WAITING = "there is none; one is started when it is due"
    STARTING = "it is starting"
    SERVING = "it guards"
    STALLED = "it stands still"
    KILLED = "it was sent SIGKILL and has not ended yet"
    LOST = "it is dead, or as good as"
    ENDED = "it ended, and so does the supervisor"


class SupervisorAction(Enum):
    """What is to be done."""

    SPAWN = "start a guard"
    BRAKE = "stop the robot, and keep it stopped"
    RELEASE = "let the stop come to its end: the guard is there"
    TERMINATE = "tell the guard to end"
    KILL = "kill the guard"
    LEAVE = "end the supervisor too"


@dataclass(frozen=True, slots=True)
class GuardObservation:
    """What is seen of the guard: how long it has not beaten (ns), and what it says of itself.

    `delay` is how late processes are on this machine now (ns), `undelivered` how long (ns) nothing
    that was sent into the guard has come out of it.
    """

    silence: int
    is_serving: bool
    is_leaving: bool = False
    delay: int = 0
    undelivered: int = 0


class SupervisorFsm:
    """Turns what is seen into what is to be done; `code` is what the supervisor ends with."""

    def __init__(self, now: int, bounds: Supervision) -> None:
        self._bounds = bounds
        self.phase = GuardPhase.WAITING
        self.code = OK
        self._phase_since = now
        self._restart_due = now
        self._serving_since: int | None = None
        self._has_served = False
        self._failures = 0
        self._is_ending = False
        self.is_undelivered = False
        """Whether the guard gives signs of life, and what is sent into it does not come out."""
        self._start_timeout = bounds.start_within

    def tick(self, now: int, observation: GuardObservation) -> tuple[SupervisorAction, ...]:
        """Look at the guard, every few milliseconds."""
        match self.phase:
            case GuardPhase.WAITING:
                return self._wait(now)
            case GuardPhase.STARTING:
                return self._start(now, observation)
            case GuardPhase.SERVING | GuardPhase.STALLED:
                return self._watch(now, observation)
            case GuardPhase.LOST if now - self._phase_since > LOST_TIMEOUT:
                self._phase_since = now
                return (SupervisorAction.KILL,)
            case _:
                return ()

    def connection_lost(self, now: int) -> tuple[SupervisorAction, ...]:
        """Take note that the connection to the guard has ended: it is dead, or will be."""
        if self.phase in (GuardPhase.LOST, GuardPhase.ENDED, GuardPhase.WAITING):
            return ()
        self.phase, self._phase_since = GuardPhase.LOST, now
        return (SupervisorAction.BRAKE,) if self._has_served else ()

    def spare_taken(self) -> None:
        """Take note that the guard which begins was ready, and needs little time."""
        self._start_timeout = WARM_START_TIMEOUT

    def start_failed(self, now: int) -> None:
        """Take note that no guard could be started: another attempt is due later."""
        self._await_next(now)

    def guard_ended(self, now: int, code: int) -> tuple[SupervisorAction, ...]:
        """Take note of the guard's exit code, minus the signal if one has killed it."""
        refused = code == REFUSED and not self._has_served
        if self._is_ending or refused or code == OK:
            return self._leave(REFUSED if refused and not self._is_ending else OK)
        self._await_next(now)
        return ()

    def shut_down(self, now: int) -> tuple[SupervisorAction, ...]:
        """End: the guard first."""
        if self._is_ending or self.phase is GuardPhase.ENDED:
            return ()
        self._is_ending, self._phase_since = True, now
        if self.phase is GuardPhase.WAITING:
            return self._leave(OK)
        return (SupervisorAction.TERMINATE,)

    def replace_guard(self) -> bool:
        """Let the guard be killed to make place for the next one, if it guards; return whether."""
        if self.phase is not GuardPhase.SERVING or self._is_ending:
            return False
        self.phase = GuardPhase.KILLED
        return True

    @property
    def restart_due(self) -> int:
        """When the next guard is started, ns."""
        return self._restart_due

    def _wait(self, now: int) -> tuple[SupervisorAction, ...]:
        if now < self._restart_due:
            return ()
        self.phase, self._phase_since = GuardPhase.STARTING, now
        self._start_timeout = self._bounds.start_within
        return (SupervisorAction.SPAWN,)

    def _start(self, now: int, observation: GuardObservation) -> tuple[SupervisorAction, ...]:
        if self._is_overdue(now) or now - self._phase_since > self._start_timeout:
            return self._kill()
        if not observation.is_serving:
            return ()
        self.phase, self._serving_since, self._has_served = GuardPhase.SERVING, now, True
        return (SupervisorAction.RELEASE,)

    def _watch(self, now: int, observation: GuardObservation) -> tuple[SupervisorAction, ...]:
        if observation.is_leaving and not self._is_ending:
            self._is_ending, self._phase_since = True, now
        is_useless = not observation.is_leaving and self._is_useless(observation)
        if is_useless or self._is_overdue(now):
            return self._kill()
        is_stalled = observation.is_leaving or self._is_silent(observation)
        self.is_undelivered = not is_stalled and self._is_stuck(observation)
        is_stalled |= self.is_undelivered
        if is_stalled == (self.phase is GuardPhase.STALLED):
            return ()
        self.phase = GuardPhase.STALLED if is_stalled else GuardPhase.SERVING
        return (SupervisorAction.BRAKE,) if is_stalled else (SupervisorAction.RELEASE,)

    def _is_silent(self, observation: GuardObservation) -> bool:
        """Tell whether the guard is silent for longer than the machine explains."""
        stall_after = adapt_bound(self._bounds.stall_after, observation.delay, LONGEST_STALL)
        return observation.silence >= stall_after

    def _is_stuck(self, observation: GuardObservation, patience: int = 1) -> bool:
        """Tell whether nothing comes out of the guard for longer than the machine explains."""
        late = min(3 * observation.delay, self._bounds.deliver_within)
        return observation.undelivered >= patience * (self._bounds.deliver_within + late)

    def _is_useless(self, observation: GuardObservation) -> bool:
        """Tell whether only the next guard can let the robot go on."""
        is_dead = observation.silence >= self._bounds.kill_after
        return is_dead or self._is_stuck(observation, USELESS_AFTER)

    def _is_overdue(self, now: int) -> bool:
        return self._is_ending and now - self._phase_since > END_TIMEOUT

    def _kill(self) -> tuple[SupervisorAction, ...]:
        self.phase = GuardPhase.KILLED
        return (SupervisorAction.KILL,)

    def _leave(self, code: int) -> tuple[SupervisorAction, ...]:
        self.phase, self.code = GuardPhase.ENDED, code
        return (SupervisorAction.LEAVE,)

    def _await_next(self, now: int) -> None:
        self._restart_due = now + self._delay(now)
        self._serving_since = None
        self.is_undelivered = False
        self.phase = GuardPhase.WAITING

    def _delay(self, now: int) -> int:
        """Return how long to wait: not at all after a guard that served, ever longer otherwise."""
        if self._serving_since is not None and now - self._serving_since >= _BACKOFF_RESET_AFTER:
            self._failures = 0
            return 0
        self._failures += 1
        return int(min(_FIRST_DELAY << min(self._failures - 1, 10), _MAX_DELAY))
