"""The stop wave: what moved the robot has fallen silent or may not go on, so it is brought to rest.

A ramp no steeper than the plan's limits, the whole velocity scaled so that the robot stays on its
curve, then zeros for a while, then nothing: others may drive. A message that goes out ends it.
"""

from collections.abc import Callable
from dataclasses import dataclass

from rtron.policies.state_machine import Effect, Machine, Named, Table
from rtron.vocabulary import SECOND, Flow, OnSilence, Stop, Velocity

# A velocity that takes longer to brake was never driven: its sender erred, or wants no stop.
LONGEST = 10 * SECOND


class State(Named):
    """The states of a stop."""

    RESTING = "nothing moves the robot"
    MOVING = "the robot follows what went out last"
    RELEASED = "the flow that moved the robot is silent, which is allowed"
    STOPPING = "the stop wave is sent"


class Input(Named):
    """What happens to a stop."""

    SAID = "a message goes out"
    SILENT = "the flow that moves the robot is silent: stop"
    RELEASED = "the flow that moves the robot is silent: release"
    REFUSED = "what moves the robot may not go on"
    BRAKED = "nobody may move the robot until the brake is loosened"
    AT_REST = "the robot was told to rest for long enough, or was not moving"


TABLE: Table[State, Input] = {
    (State.RESTING, Input.SAID): (State.MOVING, Effect.NOTHING),
    (State.RESTING, Input.SILENT): (State.RESTING, Effect.NEVER),
    (State.RESTING, Input.RELEASED): (State.RESTING, Effect.NEVER),
    (State.RESTING, Input.REFUSED): (State.RESTING, Effect.NOTHING),
    (State.RESTING, Input.BRAKED): (State.STOPPING, Effect.STOP),
    (State.RESTING, Input.AT_REST): (State.RESTING, Effect.NEVER),
    (State.MOVING, Input.SAID): (State.MOVING, Effect.NOTHING),
    (State.MOVING, Input.SILENT): (State.STOPPING, Effect.STOP),
    (State.MOVING, Input.RELEASED): (State.RELEASED, Effect.NOTHING),
    (State.MOVING, Input.REFUSED): (State.STOPPING, Effect.STOP),
    (State.MOVING, Input.BRAKED): (State.STOPPING, Effect.STOP),
    (State.MOVING, Input.AT_REST): (State.MOVING, Effect.NEVER),
    (State.RELEASED, Input.SAID): (State.MOVING, Effect.NOTHING),
    (State.RELEASED, Input.SILENT): (State.RELEASED, Effect.NEVER),
    (State.RELEASED, Input.RELEASED): (State.RELEASED, Effect.NEVER),
    (State.RELEASED, Input.REFUSED): (State.STOPPING, Effect.STOP),
    (State.RELEASED, Input.BRAKED): (State.STOPPING, Effect.STOP),
    (State.RELEASED, Input.AT_REST): (State.RELEASED, Effect.NEVER),
    (State.STOPPING, Input.SAID): (State.MOVING, Effect.NOTHING),
    (State.STOPPING, Input.SILENT): (State.STOPPING, Effect.NEVER),
    (State.STOPPING, Input.RELEASED): (State.STOPPING, Effect.NEVER),
    (State.STOPPING, Input.REFUSED): (State.STOPPING, Effect.NOTHING),
    (State.STOPPING, Input.BRAKED): (State.STOPPING, Effect.NOTHING),
    (State.STOPPING, Input.AT_REST): (State.RESTING, Effect.NOTHING),
}


@dataclass(frozen=True, slots=True)
class Ramp:
    """A velocity on its way to zero: `began` (ns), at rest after `lasts` (ns)."""

    velocity: Velocity
    began: int
    lasts: int

    @classmethod
    def of(cls, velocity: Velocity, stop: Stop, now: int) -> "Ramp":
        """Return the steepest ramp within the limits of `stop`, but none above `LONGEST`.

        A turn that would take longer does not count: it ends with the linear part.
        """
        slows = min(velocity.speed / stop.decel * SECOND, LONGEST)
        turns = velocity.turn / stop.angular_decel * SECOND
        return cls(velocity, now, round(max(slows, turns) if turns <= LONGEST else slows))

    def at(self, now: int) -> Velocity:
        """Return what the velocity is at `now`."""
        left = self.began + self.lasts - now
        return self.velocity.scaled(left / self.lasts if left > 0 else 0.0)


class Stopping:
    """Watches what goes out on one velocity stream, and stops the robot when it must."""

    def __init__(self, stop: Stop, velocity: Callable[[], Velocity | None]) -> None:
        """`velocity` tells what went out last; None if that is no velocity that can be read."""
        self._stop = stop
        self._velocity = velocity
        self._machine = Machine(TABLE, State.RESTING)
        self._flow = Flow(name="", publisher="")
        self._spoke = 0
        self._ramp = Ramp(Velocity(()), 0, 0)
        self._next = 0
        self._braked = False
        self.why = ""
        self.stops = 0

    @property
    def stopped(self) -> str:
        """The flow that moved the robot last."""
        return self._flow.name

    @property
    def released(self) -> bool:
        """Whether the flow that moved the robot is silent, which is allowed."""
        return self._machine.state is State.RELEASED

    @property
    def flow(self) -> Flow | None:
        """The flow that moves the robot, or may still do so; None while none does."""
        return self._flow if self._machine.state in (State.MOVING, State.RELEASED) else None

    def said(self, flow: Flow, now: int) -> None:
        """Note that a message of `flow` went out at `now`."""
        self._machine.step(Input.SAID)
        self._flow, self._spoke, self.why = flow, now, ""

    def refuse(self, why: str, now: int) -> None:
        """Stop the robot: what moves it may not go on.

        What was released may have come to rest by itself: a ramp would set it in motion again.
        """
        released = self.released
        if self._machine.step(Input.REFUSED) is Effect.STOP:
            self._begin(why, now, ramped=not released)

    def brake(self, why: str, now: int) -> None:
        """Stop the robot, and keep telling it to rest until `loosen`, whoever else moves it."""
        velocity = self._velocity() if self._machine.state is State.MOVING else None
        self._braked = True
        if self._machine.step(Input.BRAKED) is Effect.STOP:
            self._start(velocity, why, now)
        self.why = why

    def explain(self, why: str) -> None:
        """Take another reason for a stop that is under way; the ramp goes on as it is."""
        if self._machine.state is State.STOPPING:
            self.why = why

    def loosen(self) -> None:
        """Let the stop end as any other."""
        self._braked = False

    def interrupt(self) -> None:
        """Somebody else has stopped the robot: it may be at rest, as after a release."""
        if self._machine.state is State.MOVING:
            self._machine.step(Input.RELEASED)

    def tick(self, now: int) -> Velocity | None:
        """Return the velocity that goes out at `now`, if one is due."""
        if self._machine.state is State.MOVING and now >= self._spoke + self._flow.silent_after:
            self._fall_silent(now)
        if self._machine.state is not State.STOPPING or now < self._next:
            return None
        return self._go_on(now)

    def deadline(self) -> int | None:
        """Return when `tick` next has something to do."""
        state = self._machine.state
        if state is State.MOVING:
            return self._spoke + self._flow.silent_after
        return self._next if state is State.STOPPING else None

    def _fall_silent(self, now: int) -> None:
        if self._flow.on_silence is OnSilence.RELEASE:
            self._machine.step(Input.RELEASED)
        else:
            self._machine.step(Input.SILENT)
            silent = self._flow.silent_after / SECOND
            why = f"{self._flow.name} has been silent for {silent:.2f} s"
            self._begin(why, now, ramped=True)

    def _begin(self, why: str, now: int, *, ramped: bool) -> None:
        velocity = self._velocity()
        if velocity is not None and not velocity.moves:
            self._machine.step(Input.AT_REST)
            return
        self._start(velocity if ramped else None, why, now)

    def _start(self, velocity: Velocity | None, why: str, now: int) -> None:
        self.why = why
        self.stops += 1
        self._ramp = Ramp.of(velocity or Velocity(()), self._stop, now)
        self._next = now

    def _go_on(self, now: int) -> Velocity | None:
        self._next = now + self._stop.period
        over = now >= self._ramp.began + self._ramp.lasts + self._stop.repeat
        if over and not self._braked:
            self._machine.step(Input.AT_REST)
            self.why = ""
            return None
        return self._ramp.at(self._next)
