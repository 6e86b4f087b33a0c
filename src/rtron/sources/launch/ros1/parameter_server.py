"""The parameter server, and what one launch does to it (ROS wiki: roslaunch/XML/rosparam).

roslaunch deletes and clears first, then sets every parameter once, in the order in which their
names were first met and with the value met last: nothing that the same launch sets is ever
deleted by it. Nodes that run `rosparam load` come later.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros1.loader_context import Doubt
from rtron.sources.launch.ros1.substitution_args import as_pattern
from rtron.vocabulary import Evidence, Parameter, Parameters, ParameterValue, UnknownValue
from rtron.vocabulary.launch import canonical_name, resolve_name

_Tree: TypeAlias = dict[str, Any]

MAX_SET = 500_000

_SETTER = "/roslaunch"
_DOUBTED = UnknownValue("whether it is set hangs on a condition that is not known")


def join_names(namespace: str, name: str) -> str:
    """Return a name below a namespace; `/absolute` and `~private` names stay as they are."""
    if name.startswith(("/", "~")) or not namespace:
        return name
    return f"{namespace.rstrip('/')}/{name}"


@dataclass(slots=True)
class ParameterServer:
    """The tree of all parameters, as the master keeps it."""

    _root: _Tree = field(default_factory=dict)

    def set(self, name: str, parameter: Parameter) -> None:
        """Set a name to a value; what stood there goes, above it only what is no namespace."""
        *folders, last = _parts(name) or [""]
        place = self._root
        for folder in folders:
            if not isinstance(place.get(folder), dict):
                place[folder] = {}
            place = place[folder]
        if last:
            place[last] = _with_evidence(parameter.value, parameter.evidence)

    def delete(self, name: str) -> None:
        """Delete a name and all below it, if it is there; the root stays."""
        *folders, last = _parts(name) or [""]
        place: Any = self._root
        for folder in folders:
            place = place.get(folder) if isinstance(place, dict) else None
        if isinstance(place, dict):
            place.pop(last, None)

    def has_below(self, name: str) -> bool:
        """Tell whether a name is a namespace that holds something."""
        place: Any = self._root
        for part in _parts(name):
            place = place.get(part) if isinstance(place, dict) else None
        return isinstance(place, dict) and bool(place)

    def parameters(self) -> Parameters:
        """Return all that is set, leaf by leaf."""
        return Parameters(leaves=dict(_leaves("", self._root)))


@dataclass(slots=True)
class LaunchParameters:
    """What one launch deletes, clears and sets, at most MAX_SET times."""

    deleted: list[str] = field(default_factory=list)
    cleared: list[str] = field(default_factory=list)
    _late: list[tuple[str, Parameter]] = field(default_factory=list)
    _count: int = 0
    _set: dict[str, Parameter] = field(default_factory=dict)
    _unknown: dict[str, Parameter] = field(default_factory=dict)

    def set(
        self, name: str, value: ParameterValue, evidence: Evidence, doubt: Doubt = Doubt.NONE
    ) -> None:
        """Set a parameter in a place of the launch.

        Where conditions around it are not known, a name with two different values has no known
        one; where its own condition is not known, it has none. Raise UnresolvableError past
        MAX_SET.
        """
        self._spend()
        key = as_pattern(canonical_name(name))
        earlier = self._set.get(key)
        contradicts = earlier is not None and earlier.value != value
        if doubt is Doubt.OWN or (doubt is Doubt.AROUND and contradicts):
            value = _DOUBTED
        self._set[key] = Parameter(value=value, evidence=evidence)

    def set_late(self, name: str, parameter: Parameter) -> None:
        """Set a parameter when all others are set, as a node does; raise as `set` does."""
        self._spend()
        self._late.append((name, parameter))

    def _spend(self) -> None:
        self._count += 1
        if self._count > MAX_SET:
            raise UnresolvableError(f"not set: the launch sets {MAX_SET} parameters without it")

    def clear(self, namespace: str, doubt: Doubt) -> None:
        """Clear all below a namespace, if that is sure; what this launch sets comes after."""
        if not doubt:
            self.cleared.append(as_pattern(namespace))

    def set_unknown(self, namespace: str, why: str, evidence: Evidence) -> None:
        """Say that what a file would set below a namespace is not known."""
        key = as_pattern(resolve_name(namespace, _SETTER))
        self._unknown[key] = Parameter(value=UnknownValue(why), evidence=evidence)

    def apply(self, server: ParameterServer) -> None:
        """Do to a server what roslaunch does to it."""
        for name in (*self.deleted, *self.cleared):
            server.delete(name)
        for name, parameter in (*self._set.items(), *self._late):
            server.set(resolve_name(name, _SETTER), parameter)
        for name, parameter in self._unknown.items():
            if not server.has_below(name):
                server.set(name, parameter)


def _parts(name: str) -> list[str]:
    return [part for part in name.split("/") if part]


def _with_evidence(value: ParameterValue, evidence: Evidence) -> _Tree | Parameter:
    if not isinstance(value, dict):
        return Parameter(value=value, evidence=evidence)
    return {str(key): _with_evidence(inner, evidence) for key, inner in value.items()}


def _leaves(name: str, tree: _Tree) -> Iterator[tuple[str, Parameter]]:
    for key, inner in tree.items():
        if isinstance(inner, Parameter):
            yield f"{name}/{key}", inner
        else:
            yield from _leaves(f"{name}/{key}", inner)
