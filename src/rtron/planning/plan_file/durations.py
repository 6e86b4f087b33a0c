"""Durations as people write them: `0.5`, `200 ms`, `2 min`; inside, integer nanoseconds."""

import re
from decimal import Decimal

from rtron.errors import suggestion
from rtron.planning.plan_file.problems import quoted
from rtron.vocabulary import SECOND

UNITS = {"ns": 1, "us": 1_000, "ms": 1_000_000, "s": SECOND, "min": 60 * SECOND, "h": 3600 * SECOND}
MAX_DURATION = 2**63 - 1
_DURATION = re.compile(r"([0-9]{1,19}(?:\.[0-9]{1,18})?) ?([A-Za-zµ]*)")


def parse_duration(text: str) -> int:
    """Return a duration in ns; a bare number counts seconds. Raise ValueError with the fault."""
    match = _DURATION.fullmatch(text.strip())
    if not match:
        raise ValueError(f"{quoted(text)} is no duration: write seconds (0.5) or a unit (200 ms)")
    number, unit = match.groups()
    if unit and unit not in UNITS:
        raise ValueError(f"unknown unit {quoted(unit)}: {suggestion(unit, UNITS)}")
    duration = Decimal(number) * UNITS[unit or "s"]
    if duration != int(duration):
        raise ValueError(f"{quoted(text)} is finer than a nanosecond")
    if duration > MAX_DURATION:
        raise ValueError(f"{quoted(text)} is longer than 292 years")
    return int(duration)


def write_duration(duration: int) -> str:
    """Write a duration (ns) in seconds, exactly."""
    seconds, rest = divmod(duration, SECOND)
    decimals = f".{rest:09d}".rstrip("0") if rest else ""
    return f"{seconds}{decimals} s"
