"""Figures as people read them, and round numbers at or above a figure."""

import math

from rtron.planning.plan_file.quantities import write_duration
from rtron.vocabulary import SECOND

_STEPS = (10, 12, 15, 20, 25, 30, 40, 50, 60, 80, 100)
_LONG = 100 * SECOND
_SHORT = SECOND // 1000


def round_up(duration: int) -> int:
    """Return a duration (ns, at least 0) of a round number that is not below: 0.31 s gives 0.4 s.

    It is at most a third above.
    """
    if duration <= _STEPS[0]:
        return _STEPS[0]
    unit: int = 10 ** (len(str(duration)) - 2)
    digits = -(-duration // unit)
    fitting = next(step for step in _STEPS if step >= digits)
    return unit * fitting


def round_up_value(value: float) -> float:
    """Return a round number that is not below a positive one."""
    exponent = math.floor(math.log10(value)) - 1
    steps = (float(f"{step}e{exponent}") for step in (*_STEPS, 2 * _STEPS[-1]))
    return next(step for step in steps if step >= value)


def short_duration(duration: int) -> str:
    """Return a duration in few digits."""
    if duration >= _LONG:
        return f"{duration / SECOND:.0f} s"
    if 0 < duration < _SHORT:
        return f"{duration / _SHORT:.2g} ms"
    return f"{duration / SECOND:.3g} s"


def count_text(count: int, unit: str) -> str:
    """Return `1 gap`, `12 408 gaps`."""
    return f"{count:,} {unit}{'' if count == 1 else 's'}".replace(",", " ")


def plan_duration(duration: int | None) -> str:
    """Return a duration as the plan has it; nothing for one that is not there."""
    return "" if duration is None else write_duration(duration)
