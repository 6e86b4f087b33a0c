"""Generated velocity messages, and what is wrong with what a limit made of them.

The generator draws floats from a pool that it makes anew for every limit: NaN, Inf, both zeros,
denormals, the largest, values one step beside the limit, any bits at all, and what robots drive,
forwards and backwards. The check is no part of the guard: it unpacks both messages by itself.
"""

import math
import random
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from bench.ros1.messages import PREFIX

_ODD = (0.0, -0.0, math.nan, -math.nan, math.inf, -math.inf)
_TINY = (5e-324, -5e-324, 1e-310, 1e-45, -1e-45, 2.3e-308, 1e-200)
_HUGE = (1.7976931348623157e308, -1.7976931348623157e308, -1e160, 3.4028234663852886e38, -3.4e38)
_DRIVEN, _ANY_BITS = 200, 24
_LIMITS = (0.0, 1e-300, 1e-45, 1e-9, 0.22, 1.0, 1e9, 1e160, 1.7976931348623157e308)
_CURVATURE = 1e-9


@dataclass(frozen=True, slots=True)
class Kind:
    """A message type of nothing but floats (`floats` in the words of `struct`).

    The linear part is `linear` floats from `first` on. All others turn the robot where it `turns`
    at a rate; elsewhere they have to stay as they are.
    """

    type: str
    floats: str
    first: int = 0
    linear: int = 1
    turns: bool = False

    @property
    def layout(self) -> struct.Struct:
        """What packs and unpacks the body."""
        return struct.Struct(f"<{self.floats}")


KINDS = {
    Kind("geometry_msgs/Twist", "6d", linear=3, turns=True): 0.7,
    Kind("ackermann_msgs/AckermannDrive", "5f", first=2): 0.1,
    Kind("std_msgs/Float64", "1d"): 0.1,
    Kind("std_msgs/Float32", "1f"): 0.1,
}
"""The types, and the part of the messages that is of each."""


def random_limit(draw: random.Random) -> float:
    """Return a limit, m/s; curvature cannot be kept under a denormal one, which no plan has."""
    return draw.choice((*_LIMITS, draw.uniform(0.0, 3.0), 10 ** draw.uniform(-250, 250)))


def messages(kind: Kind, limit: float, count: int, draw: random.Random) -> Iterator[bytes]:
    """Yield `count` framed messages of a type, many of them close to the limit."""
    pool = list(_pool(kind.floats[-1], limit, draw))
    prefix, number = PREFIX.pack(kind.layout.size), int(kind.floats[:-1])
    for _ in range(count):
        yield prefix + b"".join(draw.choices(pool, k=number))


def _pool(code: str, limit: float, draw: random.Random) -> Iterator[bytes]:
    beside = (limit, math.nextafter(limit, 0), math.nextafter(limit, math.inf))
    driven = [draw.uniform(-3.0, 3.0) for _ in range(_DRIVEN)]
    for value in (*_ODD, *_TINY, *_HUGE, *beside, *(-each for each in beside), *driven):
        yield _packed(code, value)
    for _ in range(_ANY_BITS):
        yield draw.randbytes(struct.calcsize(code))


def _packed(code: str, value: float) -> bytes:
    try:
        return struct.pack(f"<{code}", value)
    except OverflowError:
        return struct.pack(f"<{code}", math.copysign(math.inf, value))


class VelocityCheck:
    """Looks for what must not be in a message of one type under one limit."""

    def __init__(self, kind: Kind, limit: float) -> None:
        self._limit = limit
        self._unpack = kind.layout.unpack_from
        self._linear = slice(kind.first, kind.first + kind.linear)
        steering = partial(_same_steering, linear=self._linear)
        self._is_preserved = _same_curve if kind.turns else steering

    def violations(self, original: bytes, limited: bytes) -> Iterator[str]:
        """Yield what is wrong with the message that went on instead of the one asked for."""
        values = self._unpack(limited, PREFIX.size)
        if not all(map(math.isfinite, values)):
            yield "not_finite"
        if not math.hypot(*values[self._linear]) <= self._limit:
            yield "above"
        if limited is not original and not self._is_preserved(
            self._unpack(original, PREFIX.size), values
        ):
            yield "curvature"


def _same_curve(original: Sequence[float], limited: Sequence[float]) -> bool:
    """Tell whether a Twist drives the same way: direction, and turn by metre. Rest is no curve."""
    if not any(limited):
        return True
    pairs = zip(_curve(original), _curve(limited), strict=True)
    return all(math.isclose(*pair, rel_tol=_CURVATURE, abs_tol=_CURVATURE) for pair in pairs)


def _curve(values: Sequence[float]) -> Sequence[float]:
    speed = math.hypot(*values[:3])
    if math.isinf(speed):
        return _curve([each / 4 for each in values])
    return [each / speed if speed else math.nan for each in values]


def _same_steering(original: Sequence[float], limited: Sequence[float], linear: slice) -> bool:
    """Tell whether all but the one speed is as it was, and that not reversed."""
    one, other = list(original), list(limited)
    (before,), (after,) = one[linear], other[linear]
    one[linear] = other[linear] = []
    return one == other and (after == 0 or math.copysign(1, before) == math.copysign(1, after))
