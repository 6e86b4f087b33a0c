"""Quantities as people write them: `0.22 m/s`, `0.8 km/h`, `90 deg`; inside, floats in SI units."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

from rtron.errors import suggestion
from rtron.planning.plan_file.problems import quoted
from rtron.vocabulary import SECOND

_NUMBER = r"-?[0-9]{1,19}(?:\.[0-9]{1,25})?(?:[eE][+-]?[0-9]{1,3})?"
_QUANTITY = re.compile(rf"({_NUMBER}) ?([A-Za-zµ°].{{0,20}})?")
_FLOAT_LIMIT = 10**300
_DEGREE = Fraction(math.pi) / 180


@dataclass(frozen=True, slots=True)
class Quantity:
    """What is measured, in which units (the first is the SI unit), and between which bounds.

    Where `min_nonzero` is given, nothing but 0 is closer to 0: it would be a slip.
    """

    description: str
    units: Mapping[str, Fraction]
    minimum: float
    maximum: float
    min_nonzero: float = 0.0

    @property
    def unit(self) -> str:
        """The SI unit, which a bare number has."""
        return next(iter(self.units))

    @property
    def pattern(self) -> str:
        """What a text with a unit looks like, as an expression."""
        return rf"{_NUMBER} ?({'|'.join(map(re.escape, self.units))})?"

    def parse(self, text: str) -> float:
        """Return a quantity in the SI unit. Raise ValueError with the fault."""
        match = _QUANTITY.fullmatch(text.strip())
        if not match:
            raise ValueError(
                f"{quoted(text)} is no {self.description}: write a number and {self.unit}"
            )
        number, unit = match[1], match[2] or self.unit
        if unit not in self.units:
            raise ValueError(f"unknown unit {quoted(unit)}: {suggestion(unit, self.units)}")
        return self._bounded(Fraction(number) * self.units[unit], text)

    def write(self, value: float) -> str:
        """Write a quantity with its SI unit, so that it is read as the same float."""
        return f"{repr(value).removesuffix('.0')} {self.unit}"

    def _bounded(self, exact: Fraction, text: str) -> float:
        value = float(exact) if abs(exact) < _FLOAT_LIMIT else math.inf
        if not self.minimum <= value <= self.maximum:
            bounds = f"{self.minimum:g} and {self.write(self.maximum)}"
            raise ValueError(f"{quoted(text)} is not between {bounds}")
        if exact and abs(value) < self.min_nonzero:
            raise ValueError(f"{quoted(text)} is closer to 0 than {self.write(self.min_nonzero)}")
        return value


def _metric(per: str = "", **more: Fraction) -> dict[str, Fraction]:
    scale = {"m": Fraction(1), "cm": Fraction(1, 100), "mm": Fraction(1, 1000)}
    return {f"{unit}{per}": factor for unit, factor in scale.items()} | more


def _squared(unit: str, factor: Fraction) -> dict[str, Fraction]:
    return {f"{unit}/s{power}": factor for power in ("2", "^2", "²")}


VELOCITY = Quantity(
    "velocity",
    {**_metric("/s"), "km/h": Fraction(5, 18)},
    minimum=0,
    maximum=1000,
    min_nonzero=1e-6,
)
ANGULAR_VELOCITY = Quantity(
    "angular velocity",
    {"rad/s": Fraction(1), "deg/s": _DEGREE},
    minimum=0,
    maximum=1000,
    min_nonzero=1e-6,
)
PER_FRAME = Quantity("distance per frame", _metric("/frame"), minimum=1e-6, maximum=1000)
ACCELERATION = Quantity("acceleration", _squared("m", Fraction(1)), minimum=0.01, maximum=1000)
DECELERATION = Quantity("deceleration", _squared("m", Fraction(1)), minimum=0.01, maximum=1000)
ANGULAR_DECELERATION = Quantity(
    "angular deceleration",
    {**_squared("rad", Fraction(1)), **_squared("deg", _DEGREE)},
    minimum=0.01,
    maximum=1000,
)
POSITION = Quantity("position", _metric(km=Fraction(1000)), minimum=-1e8, maximum=1e8)
# A yaw beyond a whole turn is one in degrees whose unit was forgotten.
YAW = Quantity(
    "angle", {"rad": Fraction(1), "deg": _DEGREE}, minimum=-2 * math.pi, maximum=2 * math.pi
)


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
