"""What functions typically exchange: `interactions.yaml`, as values."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.functions.repository import load_package_yaml
from rtron.vocabulary import Domain, FunctionType, RecognitionSubfunction

SENSORS = FunctionType.SENSORS.value


@dataclass(frozen=True, slots=True, kw_only=True)
class TypicalTraffic:
    """The message types that a function typically publishes and subscribes, in ROS 1 spelling."""

    publishes: frozenset[str] = frozenset()
    subscribes: frozenset[str] = frozenset()
    source: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class EnvironmentEffect:
    """What `sources` functions change around the robot, and whom that reaches."""

    through: str
    sources: tuple[str, ...]
    targets: tuple[str, ...]


@cache
def typical_traffic() -> Mapping[str, TypicalTraffic]:
    """Return the typical traffic by function type, and by subfunction of Recognition."""
    return {name: _parse_traffic(entry) for name, entry in _data()["functions"].items()}


@cache
def environment_effects() -> tuple[EnvironmentEffect, ...]:
    """Return what acts on the environment, and whom the change reaches."""
    return tuple(
        EnvironmentEffect(
            through=each["through"], sources=tuple(each["from"]), targets=tuple(each["to"])
        )
        for each in _data()["indirect"]
    )


def function_of(name: str) -> FunctionType:
    """Return the function type of a name: a subfunction's is Recognition."""
    if name in _SUBFUNCTIONS:
        return FunctionType.RECOGNITION
    return FunctionType(name)


def is_typical_flow(source: str, target: str) -> bool:
    """Tell whether what is typical flows from one function to the other (paper 2.1)."""
    return _stage(target) in _workflow()[_stage(source)]


def is_informative(type: str) -> bool:
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
    every = (
        type for each in typical_traffic().values() for type in each.publishes | each.subscribes
    )
    return frozenset(type for type in every if "/action/" in type)


def _parse_traffic(entry: Mapping[str, Any]) -> TypicalTraffic:
    return TypicalTraffic(
        publishes=frozenset(entry.get("publishes", ())),
        subscribes=frozenset(entry.get("subscribes", ())),
        source=entry["source"],
    )


def _stage(name: str) -> str:
    """Return the stage of the workflow; sensors stand before it, apart from the other drivers."""
    domain: Domain = DOMAIN_BY_TYPE[function_of(name)]
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
    data: Mapping[str, Any] = load_package_yaml("rtron.functions.interactions", "interactions.yaml")
    return data


_SUBFUNCTIONS = frozenset(subfunction.value for subfunction in RecognitionSubfunction)

_WORD = re.compile(r"[a-z0-9]+")


def subfunction_of(
    name: str, description: str = "", subscribes: Collection[str] = ()
) -> RecognitionSubfunction | None:
    """Return the subfunction that a package's name tells, its description or what it subscribes."""
    for text in (name, description):
        words = frozenset(_WORD.findall(text.lower()))
        by_word = next((sub for sub, keywords, _ in _table() if words & keywords), None)
        if by_word:
            return by_word
    subscribed = frozenset(subscribes)
    return next((sub for sub, _, types in _table() if subscribed & types), None)


@cache
def _table() -> tuple[tuple[RecognitionSubfunction, frozenset[str], frozenset[str]], ...]:
    entries = load_package_yaml("rtron.functions.interactions", "interactions.yaml")["subfunctions"]
    return tuple(
        (RecognitionSubfunction(e["name"]), frozenset(e["words"]), frozenset(e["subscribes"]))
        for e in entries
    )
