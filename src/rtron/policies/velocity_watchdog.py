"""The stop wave: what moved the robot has fallen silent or may not go on, so it is brought to rest.

A ramp down to zero, then zeros for a while, then nothing: others may drive. A message that goes out
ends it. The zeros are counted: a machine that stands still meanwhile sends all of them later. The
linear part and each turn brake at their own rate, so that a turn that nobody can drive does not
keep the robot going; no part takes longer than the plan's `within`.
"""

from collections.abc import Callable
from dataclasses import dataclass

from rtron.policies.state_machine import StateMachine, TableEnum, TransitionEffect, TransitionTable
from rtron.vocabulary import SECOND, Flow, OnSilence, StopProfile, Velocity


class WatchdogState(TableEnum):
    """The states of a stop."""

    RESTING = "nothing moves the robot"
    MOVING = "the robot follows what went out last"
    RELEASED = "the flow that moved the robot is silent, which is allowed"
    STOPPING = "the stop wave is sent"


class WatchdogInput(TableEnum):
    """What happens to a stop."""

    OUTPUT = "a message goes out"
    SILENT = "the flow that moves the robot is silent: stop"
    RELEASED = "the flow that moves the robot is silent: release"
    REFUSED = "what moves the robot may not go on"
    BRAKED = "nobody may move the robot until the brake is loosened"
    AT_REST = "the robot was told to rest for long enough, or was not moving"


TABLE: TransitionTable[WatchdogState, WatchdogInput] = {
    (WatchdogState.RESTING, WatchdogInput.OUTPUT): (WatchdogState.MOVING, TransitionEffect.NOTHING),
    (WatchdogState.RESTING, WatchdogInput.SILENT): (WatchdogState.RESTING, TransitionEffect.NEVER),
    (WatchdogState.RESTING, WatchdogInput.RELEASED): (
        WatchdogState.RESTING,
        TransitionEffect.NEVER,
    ),
    (WatchdogState.RESTING, WatchdogInput.REFUSED): (
        WatchdogState.RESTING,
        TransitionEffect.NOTHING,
    ),
    (WatchdogState.RESTING, WatchdogInput.BRAKED): (WatchdogState.STOPPING, TransitionEffect.STOP),
    (WatchdogState.RESTING, WatchdogInput.AT_REST): (WatchdogState.RESTING, TransitionEffect.NEVER),
    (WatchdogState.MOVING, WatchdogInput.OUTPUT): (WatchdogState.MOVING, TransitionEffect.NOTHING),
    (WatchdogState.MOVING, WatchdogInput.SILENT): (WatchdogState.STOPPING, TransitionEffect.STOP),
    (WatchdogState.MOVING, WatchdogInput.RELEASED): (
        WatchdogState.RELEASED,
        TransitionEffect.NOTHING,
    ),
    (WatchdogState.MOVING, WatchdogInput.REFUSED): (WatchdogState.STOPPING, TransitionEffect.STOP),
    (WatchdogState.MOVING, WatchdogInput.BRAKED): (WatchdogState.STOPPING, TransitionEffect.STOP),
    (WatchdogState.MOVING, WatchdogInput.AT_REST): (WatchdogState.MOVING, TransitionEffect.NEVER),
    (WatchdogState.RELEASED, WatchdogInput.OUTPUT): (
        WatchdogState.MOVING,
        TransitionEffect.NOTHING,
    ),
    (WatchdogState.RELEASED, WatchdogInput.SILENT): (
        WatchdogState.RELEASED,
        TransitionEffect.NEVER,
    ),
    (WatchdogState.RELEASED, WatchdogInput.RELEASED): (
        WatchdogState.RELEASED,
        TransitionEffect.NEVER,
    ),
    (WatchdogState.RELEASED, WatchdogInput.REFUSED): (
        WatchdogState.STOPPING,
        TransitionEffect.STOP,
    ),
    (WatchdogState.RELEASED, WatchdogInput.BRAKED): (WatchdogState.STOPPING, TransitionEffect.STOP),
    (WatchdogState.RELEASED, WatchdogInput.AT_REST): (
        WatchdogState.RELEASED,
        TransitionEffect.NEVER,
    ),
    (WatchdogState.STOPPING, WatchdogInput.OUTPUT): (
        WatchdogState.MOVING,
        TransitionEffect.NOTHING,
    ),
    (WatchdogState.STOPPING, WatchdogInput.SILENT): (
        WatchdogState.STOPPING,
        TransitionEffect.NEVER,
    ),
    (WatchdogState.STOPPING, WatchdogInput.RELEASED): (
        WatchdogState.STOPPING,
        TransitionEffect.NEVER,
    ),
    (WatchdogState.STOPPING, WatchdogInput.REFUSED): (
        WatchdogState.STOPPING,
        TransitionEffect.NOTHING,
    ),
    (WatchdogState.STOPPING, WatchdogInput.BRAKED): (
        WatchdogState.STOPPING,
        TransitionEffect.NOTHING,
    ),
    (WatchdogState.STOPPING, WatchdogInput.AT_REST): (
        WatchdogState.RESTING,
        TransitionEffect.NOTHING,
    ),
}


_OUTPUT, _MOVING = WatchdogInput.OUTPUT, WatchdogState.MOVING
_STOPPING, _RELEASED = WatchdogState.STOPPING, WatchdogState.RELEASED


@dataclass(frozen=True, slots=True)
class VelocityRamp:
    """A velocity on its way to zero from `started_at` (ns) on.

    `linear_duration` is the time (ns) until the linear part is at rest, as a whole: its direction
    stays. `angular_durations` are those of the turns, one for each.
    """

    velocity: Velocity
    started_at: int
    linear_duration: int
    angular_durations: tuple[int, ...] = ()

    @classmethod
    def for_stop(cls, velocity: Velocity, stop: StopProfile, now: int) -> "VelocityRamp":
        """Return the steepest ramp within the limits of `stop`, and at rest after `stop.within`.

        A turn takes at least as long as the linear part: the robot stays on its curve.
        """
        linear = _braking_time(velocity.speed, stop.decel, stop.within)
        turns = (_braking_time(abs(w), stop.angular_decel, stop.within) for w in velocity.angular)
        return cls(velocity, now, linear, tuple(max(linear, each) for each in turns))

    @property
    def duration(self) -> int:
        """The time (ns) until every part is at rest."""
        return max(self.linear_duration, *self.angular_durations, 0)

    def at(self, now: int) -> Velocity:
        """Return what the velocity is at `now`."""
        passed = now - self.started_at
        linear_share = _remaining_share(self.linear_duration, passed)
        turns = zip(self.velocity.angular, self.angular_durations, strict=True)
        return Velocity(
            tuple(each * linear_share for each in self.velocity.linear),
            tuple(each * _remaining_share(duration, passed) for each, duration in turns),
        )


def _braking_time(speed: float, decel: float, longest: int) -> int:
    return round(min(speed / decel * SECOND, longest))


def _remaining_share(duration: int, passed: int) -> float:
    return (duration - passed) / duration if passed < duration else 0.0


class VelocityWatchdog:
    """Watches what goes out on one velocity stream, and stops the robot when it must."""

    def __init__(self, stop: StopProfile, velocity: Callable[[], Velocity | None]) -> None:
        """`velocity` tells what went out last; None if that is no velocity that can be read."""
        self._stop = stop
        self._velocity = velocity
        self._machine = StateMachine(TABLE, WatchdogState.RESTING)
        self._flow = Flow(name="", publisher="")
        self._last_output = 0
        self._ramp = VelocityRamp(Velocity(()), 0, 0)
        self._next = 0
        self._zero_count = max(1, -(-stop.repeat // stop.period))
        self._zeros_left = 0
        self._braked = False
        self.reason = ""
        self.stop_count = 0

    @property
    def last_flow(self) -> str:
        """The flow that moved the robot last."""
        return self._flow.name

    @property
    def is_released(self) -> bool:
        """Whether the flow that moved the robot is silent, which is allowed."""
        return self._machine.state is WatchdogState.RELEASED

    @property
    def moving_flow(self) -> Flow | None:
        """The flow that moves the robot, or may still do so; None while none does."""
        return self._flow if self._machine.state in (_MOVING, _RELEASED) else None

    def record_output(self, flow: Flow, now: int) -> None:
        """Note that a message of `moving_flow` went out at `now`."""
        self._machine.step(_OUTPUT)
        self._flow, self._last_output, self.reason = flow, now, ""

    def refuse(self, reason: str, now: int) -> None:
        """Stop the robot: what moves it may not go on.

        What was released may have come to rest by itself: a ramp would set it in motion again.
        """
        is_released = self.is_released
        if self._machine.step(WatchdogInput.REFUSED) is TransitionEffect.STOP:
            self._stop_if_moving(reason, now, ramped=not is_released)

    def brake(self, reason: str, now: int) -> None:
        """Stop the robot and hold it at rest until `release_brake`, whoever else moves it."""
        velocity = self._velocity() if self._machine.state is WatchdogState.MOVING else None
        self._braked = True
        if self._machine.step(WatchdogInput.BRAKED) is TransitionEffect.STOP:
            self._start_ramp(velocity, reason, now)
        self.reason = reason

    def set_reason(self, reason: str) -> None:
        """Take another reason for a stop that is under way; the ramp goes on as it is."""
        if self._machine.state is WatchdogState.STOPPING:
            self.reason = reason

    def release_brake(self) -> None:
        """Let the stop end as any other."""
        self._braked = False

    def forget_flow(self, flow: str, now: int) -> None:
        """Take a flow for silent at once: nobody speaks for it any more."""
        if self._machine.state is WatchdogState.MOVING and self._flow.name == flow:
            self._handle_silence(f"{flow} has lost its publisher", now)

    def mark_stopped_elsewhere(self) -> None:
        """Somebody else has stopped the robot: it may be at rest, as after a release."""
        if self._machine.state is WatchdogState.MOVING:
            self._machine.step(WatchdogInput.RELEASED)

    def tick(self, now: int) -> Velocity | None:
        """Return the velocity that goes out at `now`, if one is due."""
        if (
            self._machine.state is WatchdogState.MOVING
            and now >= self._last_output + self._flow.silent_after
        ):
            silent = self._flow.silent_after / SECOND
            self._handle_silence(f"{self._flow.name} has been silent for {silent:.2f} s", now)
        if self._machine.state is not WatchdogState.STOPPING or now < self._next:
            return None
        return self._next_velocity(now)

    def current(self, now: int) -> Velocity | None:
        """Return the velocity of the stop that is in force at `now`, None if there is no stop."""
        is_stopping = self._machine.state is WatchdogState.STOPPING
        return self._ramp.at(max(now, self._next)) if is_stopping else None

    def deadline(self) -> int | None:
        """Return when `tick` next has something to do."""
        state = self._machine.state
        if state is _MOVING:
            return self._last_output + self._flow.silent_after
        return self._next if state is _STOPPING else None

    def _handle_silence(self, why: str, now: int) -> None:
        if self._flow.on_silence is OnSilence.RELEASE:
            self._machine.step(WatchdogInput.RELEASED)
        else:
            self._machine.step(WatchdogInput.SILENT)
            self._stop_if_moving(why, now, ramped=True)

    def _stop_if_moving(self, why: str, now: int, *, ramped: bool) -> None:
        velocity = self._velocity()
        if velocity is not None and not velocity.is_moving:
            self._machine.step(WatchdogInput.AT_REST)
            return
        self._start_ramp(velocity if ramped else None, why, now)

    def _start_ramp(self, velocity: Velocity | None, why: str, now: int) -> None:
        self.reason = why
        self.stop_count += 1
        self._ramp = VelocityRamp.for_stop(velocity or Velocity(()), self._stop, now)
        self._next, self._zeros_left = now, self._zero_count

    def _next_velocity(self, now: int) -> Velocity | None:
        self._next = now + self._stop.period
        if self._zeros_left <= 0 and not self._braked:
            self._machine.step(WatchdogInput.AT_REST)
            self.reason = ""
            return None
        velocity = self._ramp.at(self._next)
        self._zeros_left -= not velocity.is_moving
        return velocity
