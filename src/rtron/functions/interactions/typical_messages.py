"""What functions typically exchange: `interactions.yaml`, as values."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from rtron.functions.domains import DOMAIN_OF
from rtron.functions.package_data import shipped
from rtron.vocabulary import Domain, FunctionType, RecognitionSubfunction

SENSORS = FunctionType.SENSORS.value


@dataclass(frozen=True, slots=True, kw_only=True)
class Traffic:
    """The message types that a function typically publishes and subscribes, in ROS 1 spelling."""

    publishes: frozenset[str] = frozenset()
    subscribes: frozenset[str] = frozenset()
    source: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """What `acting` functions change around the robot, and whom that reaches."""

    through: str
    acting: tuple[str, ...]
    reached: tuple[str, ...]


@cache
def typical() -> Mapping[str, Traffic]:
    """Return the typical traffic by function type, and by subfunction of Recognition."""
    return {name: _traffic(entry) for name, entry in _data()["functions"].items()}


@cache
def effects() -> tuple[Effect, ...]:
    """Return what acts on the environment, and whom the change reaches."""
    return tuple(
        Effect(through=each["through"], acting=tuple(each["from"]), reached=tuple(each["to"]))
        for each in _data()["indirect"]
    )


def function_of(name: str) -> FunctionType:
    """Return the function type of a name: a subfunction's is Recognition."""
    if name in _SUBFUNCTIONS:
        return FunctionType.RECOGNITION
    return FunctionType(name)


def flows(source: str, target: str) -> bool:
    """Tell whether what is typical flows from one function to the other (paper 2.1)."""
    return _stage(target) in _workflow()[_stage(source)]


def says_something(type: str) -> bool:
    """Tell whether messages of a type say anything about a state of the robot."""
    return bool(type) and _package(type) not in _packages("ignored_packages")


def is_generic(type: str) -> bool:
    """Tell whether a type has no meaning of its own, like `std_msgs/String`."""
    return _package(type) in _packages("generic_packages")


def is_ros2(package: str) -> bool:
    """Tell whether a package is one that only ROS 2 has, and that what is built for it needs."""
    return package in _packages("ros2_packages")


@cache
def ros2_types() -> frozenset[str]:
    """Return the typical types that only ROS 2 has: actions as one type."""
    every = (type for each in typical().values() for type in each.publishes | each.subscribes)
    return frozenset(type for type in every if "/action/" in type)


def _traffic(entry: Mapping[str, Any]) -> Traffic:
    return Traffic(
        publishes=frozenset(entry.get("publishes", ())),
        subscribes=frozenset(entry.get("subscribes", ())),
        source=entry["source"],
    )


def _stage(name: str) -> str:
    """Return the stage of the workflow; sensors stand before it, apart from the other drivers."""
    domain: Domain = DOMAIN_OF[function_of(name)]
    return SENSORS if name == SENSORS else domain.value


@cache
def _workflow() -> Mapping[str, frozenset[str]]:
    return {stage: frozenset(after) for stage, after in _data()["workflow"].items()}


@cache
def _packages(key: str) -> frozenset[str]:
    return frozenset(_data()[key])


def _package(type: str) -> str:
    return type.partition("/")[0]


def _data() -> Mapping[str, Any]:
    data: Mapping[str, Any] = shipped("rtron.functions.interactions", "interactions.yaml")
    return data


_SUBFUNCTIONS = frozenset(subfunction.value for subfunction in RecognitionSubfunction)
