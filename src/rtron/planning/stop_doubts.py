"""Where the stop of a plan brings the robot to rest late, roughly, or with a single message."""

from collections.abc import Iterator

from rtron.vocabulary import SECOND, Plan, StopProfile

_USUAL_SPEED = 1.0
"""What is taken (m/s, and rad/s for turning) where the plan sets no limit."""
LONGEST_STOP = 2 * SECOND
LONGEST_PERIOD = SECOND // 10
FEWEST_ZEROS = 3


def stop_doubts(plan: Plan) -> Iterator[str]:
    """Yield what is odd in how the guard of a plan stops the robot."""
    stop = plan.stop
    yield from _steeper_stop(plan)
    yield from _slow_stop(plan)
    if stop.period > LONGEST_PERIOD:
        how_long = _seconds(stop.period)
        yield f"period is {how_long}: the robot brakes in steps that long; 50 ms is usual"
    zeros = max(1, -(-stop.repeat // stop.period))
    if zeros < FEWEST_ZEROS:
        lost = "a base that misses what says 0 drives on"
        count = "one message" if zeros == 1 else f"{zeros} messages"
        yield f"a stop ends with {count} of velocity 0: {lost}; raise `repeat` (1 s)"


def _steeper_stop(plan: Plan) -> Iterator[str]:
    """Yield where the stop from the greatest speed is steeper than the plan's own ramp."""
    stop = plan.stop
    fastest = (plan.rsrcn and plan.rsrcn.max_vel_limit) or 0.0
    if fastest > stop.decel * stop.within / SECOND:
        ramp = f"at {stop.decel:g} m/s2 it takes {fastest / stop.decel:.2g} s from {fastest:g} m/s"
        yield f"every stop ends within {_seconds(stop.within)}, and {ramp}: it is steeper"


def _slow_stop(plan: Plan) -> Iterator[str]:
    stop = plan.stop
    speed = (plan.rsrcn and plan.rsrcn.max_vel_limit) or _USUAL_SPEED
    duration = _braking_time(speed, stop.decel, stop)
    if duration > LONGEST_STOP:
        metres = speed * duration / SECOND / 2
        how_far = f"from {speed:g} m/s the robot drives {metres:.2g} m on"
        yield f"a stop takes {_seconds(duration)}, and {how_far}: raise `decel`, or lower `within`"
    turning = _braking_time(_USUAL_SPEED, stop.angular_decel, stop)
    if max(turning, LONGEST_STOP) > max(duration, LONGEST_STOP):
        how_long = f"{_seconds(turning)} to end a turn of {_USUAL_SPEED:g} rad/s"
        yield f"a stop takes {how_long}: raise `angular_decel`, or lower `within`"


def _braking_time(speed: float, decel: float, stop: StopProfile) -> int:
    return round(min(speed / decel * SECOND, stop.within))


def _seconds(duration: int) -> str:
    return f"{duration / SECOND:.3g} s"
