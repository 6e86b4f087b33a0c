"""The parameter server that a launch fills (ROS wiki), and node patterns of parameter files."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from rtron.vocabulary.evidence import Evidence

ParameterValue: TypeAlias = Any
"""A string, number, bool, list or dict of these, or an UnknownValue."""


@dataclass(frozen=True, slots=True)
class UnknownValue:
    """A value that is not known before the app runs, and why."""

    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One parameter's value, and where it is set."""

    value: ParameterValue
    evidence: Evidence


@dataclass(slots=True)
class ParameterTree:
    """What stands below each absolute name, leaf by leaf; a name without a value is a namespace."""

    leaves: dict[str, Parameter] = field(default_factory=dict)

    def set(self, name: str, parameter: Parameter) -> None:
        """Set a parameter; a dict becomes one leaf an entry, and what stood below the name goes."""
        for old in [leaf for leaf in self.leaves if _is_below(leaf, name)]:
            del self.leaves[old]
        for leaf, value in _flatten(name, parameter.value):
            self.leaves[leaf] = Parameter(value=value, evidence=parameter.evidence)

    def get(self, name: str) -> Parameter | None:
        """Return a parameter, or a namespace as a dict of what stands below it; None if neither."""
        if name in self.leaves:
            return self.leaves[name]
        below = {
            leaf: parameter for leaf, parameter in self.leaves.items() if _is_below(leaf, name)
        }
        if not below:
            return None
        return Parameter(value=_nested(name, below), evidence=next(iter(below.values())).evidence)

    def search(self, name: str, namespace: str) -> str | None:
        """Return the full name found upwards from `namespace` (ROS wiki: searchParam)."""
        first = name.split("/", maxsplit=1)[0]
        parts = [part for part in namespace.split("/") if part]
        for depth in range(len(parts), -1, -1):
            prefix = "".join(f"/{part}" for part in parts[:depth])
            if self.get(f"{prefix}/{first}") is not None:
                return f"{prefix}/{name}"
        return None


def _is_below(leaf: str, name: str) -> bool:
    return leaf == name or leaf.startswith(name.rstrip("/") + "/")


def _flatten(name: str, value: ParameterValue) -> Iterator[tuple[str, ParameterValue]]:
    if not isinstance(value, Mapping):
        yield name, value
        return
    for key, inner in value.items():
        yield from _flatten(f"{name.rstrip('/')}/{str(key).strip('/')}", inner)


def _nested(name: str, below: Mapping[str, Parameter]) -> dict[str, ParameterValue]:
    tree: dict[str, ParameterValue] = {}
    for leaf, parameter in below.items():
        *folders, last = leaf[len(name.rstrip("/")) + 1 :].split("/")
        subtree = tree
        for folder in folders:
            subtree = subtree.setdefault(folder, {})
        subtree[last] = parameter.value
    return tree


def pattern_matches(pattern: str, node: str) -> bool:
    """Tell whether a pattern of a parameter file names a node (rclcpp: parameter_map)."""
    parts = absolute_pattern(pattern).split("/")[1:]
    return re.fullmatch("".join(map(_part_pattern, parts)), node) is not None


def _part_pattern(part: str) -> str:
    if part == "**":
        return r"(/[^/]+)*"
    return "/" + re.escape(part).replace(r"\*", "[^/]+")


def absolute_pattern(pattern: str) -> str:
    """Return a pattern of a parameter file with the slash that it may lack."""
    return pattern if pattern.startswith("/") else f"/{pattern}"
