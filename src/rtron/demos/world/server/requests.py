"""What a client may say to the world, checked: a role, a velocity, an order."""

from dataclasses import dataclass
from enum import Enum
from math import isfinite
from typing import Any, TypeVar

from rtron.demos.world.server.protocol import Head
from rtron.errors import WireError

CASES = ("gr", "rsr", "msr", "agent")
MAX_SEED = 2**63 - 1
CAMERA_RATE = 10.0
"""Images a simulated second, if nobody asks for another rate."""
_CAMERA_RATES = (0.1, 20.0)
_COMPUTER_RATES = (0.0, 1000.0)


class ClientRole(str, Enum):
    """What a connection is: a device of the robot, or who runs the experiment."""

    BASE = "base"
    LIDAR = "lidar"
    CAMERA = "camera"
    BATTERY = "battery"
    MISSION = "mission"
    COMPUTER = "computer"
    NETWORK = "network"
    OWNER = "owner"

    def __str__(self) -> str:
        return str(self.value)


@dataclass(frozen=True, slots=True)
class ResetRequest:
    """A wish for a new run: the robot at the start of the scene of a case and a seed."""

    case: str
    seed: int
    camera_rate: float = CAMERA_RATE


@dataclass(frozen=True, slots=True)
class StartRequest:
    """A wish to hand the mission its goal."""


@dataclass(frozen=True, slots=True)
class RateRequest:
    """A wish that the robot's computer gets through so many images a simulated second."""

    rate: float


@dataclass(frozen=True, slots=True)
class DevicesRequest:
    """A question: how many connections each role has."""


OwnerRequest = ResetRequest | StartRequest | RateRequest | DevicesRequest


def parse_role(head: Head) -> ClientRole:
    """Return the role that a client's first frame names; WireError if none."""
    try:
        return ClientRole(head.get("hello"))
    except ValueError as error:
        raise WireError("the first frame names no role") from error


def parse_velocity(head: Head) -> tuple[float, float]:
    """Return the velocity (m/s, rad/s) in a frame of the base; WireError if there is none."""
    values = head.get("velocity")
    if not isinstance(values, list) or len(values) != len(("linear", "angular")):
        raise WireError("a frame of the base has no velocity of two numbers")
    return _number(values[0], "velocity"), _number(values[1], "velocity")


def parse_request(head: Head) -> OwnerRequest:
    """Return the order in a frame of the owner; WireError if there is none."""
    name = head.get("order")
    if name == "reset":
        return _parse_reset(head)
    if name == "start":
        return StartRequest()
    if name == "rate":
        return RateRequest(_bounded_number(head.get("rate"), "rate", _COMPUTER_RATES))
    if name == "devices":
        return DevicesRequest()
    raise WireError("a frame of the owner has no order that is known")


def _parse_reset(head: Head) -> ResetRequest:
    seed = _typed_value(head.get("seed"), int, "seed")
    if not 0 <= seed <= MAX_SEED:
        raise WireError("the seed is out of its bounds")
    case = _typed_value(head.get("case"), str, "case")
    if case not in CASES:
        raise WireError(f"no case is called {case[:20]!r}")
    requested_rate = head.get("camera_rate")
    rate = (
        CAMERA_RATE
        if requested_rate is None
        else _bounded_number(requested_rate, "camera_rate", _CAMERA_RATES)
    )
    return ResetRequest(case, seed, rate)


_Kind = TypeVar("_Kind", int, str)


def _typed_value(value: Any, kind: type[_Kind], name: str) -> _Kind:  # noqa: ANN401 - a stranger's
    if not isinstance(value, kind) or isinstance(value, bool):
        raise WireError(f"{name} is no {kind.__name__}")
    return value


def _bounded_number(value: Any, name: str, bounds: tuple[float, float]) -> float:  # noqa: ANN401
    number = _number(value, name)
    if not bounds[0] <= number <= bounds[1]:
        raise WireError(f"{name} is not within {bounds[0]:g} and {bounds[1]:g}")
    return number


def _number(value: Any, name: str) -> float:  # noqa: ANN401 - a stranger's
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise WireError(f"{name} is no number")
    try:
        number = float(value)
    except OverflowError as error:
        raise WireError(f"{name} is too large") from error
    if not isfinite(number):
        raise WireError(f"{name} is not finite")
    return number
