"""The parameter server, and what one launch does to it (ROS wiki: roslaunch/XML/rosparam).

roslaunch deletes and clears first, then sets every parameter once, in the order in which their
names were first met and with the value met last: nothing that the same launch sets is ever
deleted by it. Nodes that run `rosparam load` come later.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.commands import DescribeRobot
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression_library import anonymous_to_wildcard
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.common.xml_document import LaunchDocument, parse_launch
from rtron.sources.launch.common.yaml_tree import YamlFile, parse_yaml
from rtron.sources.launch.ros1.loader_context import Uncertainty
from rtron.sources.launch.ros1.unresolved import UnresolvedNotes
from rtron.vocabulary import (
    Evidence,
    LaunchRemap,
    Parameter,
    ParameterTree,
    ParameterValue,
    UnknownValue,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.launch import canonical_name, resolve_name

_Tree: TypeAlias = dict[str, Any]

MAX_PARAMETERS = 500_000

_PLAIN = (bool, int, float, str)
_SHOWN = 80
_SETTING_NODE = "/roslaunch"
_UNCERTAIN_VALUE = UnknownValue("whether it is set hangs on a condition that is not known")


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
        *folders, last = _name_parts(name) or [""]
        subtree = self._root
        for folder in folders:
            if not isinstance(subtree.get(folder), dict):
                subtree[folder] = {}
            subtree = subtree[folder]
        if last:
            subtree[last] = _with_evidence(parameter.value, parameter.evidence)

    def delete(self, name: str) -> None:
        """Delete a name and all below it, if it is there; the root stays."""
        *folders, last = _name_parts(name) or [""]
        subtree: Any = self._root
        for folder in folders:
            subtree = subtree.get(folder) if isinstance(subtree, dict) else None
        if isinstance(subtree, dict):
            subtree.pop(last, None)

    def has_below(self, name: str) -> bool:
        """Tell whether a name is a namespace that holds something."""
        subtree: Any = self._root
        for part in _name_parts(name):
            subtree = subtree.get(part) if isinstance(subtree, dict) else None
        return isinstance(subtree, dict) and bool(subtree)

    def parameters(self) -> ParameterTree:
        """Return all that is set, leaf by leaf."""
        return ParameterTree(leaves=dict(_leaves("", self._root)))


@dataclass(slots=True)
class LaunchParameters:
    """What one launch deletes, clears and sets, at most MAX_SET times.

    `files` are the launch files that are being read, each included by the one before; `overridden`
    are the facts about what one of them sets and one within it sets again.
    """

    files: tuple[str, ...] = ()
    overridden: dict[str, WiringFact] = field(default_factory=dict)
    deleted: list[str] = field(default_factory=list)
    cleared: list[str] = field(default_factory=list)
    _set_by_nodes: list[tuple[str, Parameter]] = field(default_factory=list)
    _count: int = 0
    _set: dict[str, Parameter] = field(default_factory=dict)
    _setters: dict[str, str] = field(default_factory=dict)
    _unknown: dict[str, Parameter] = field(default_factory=dict)

    def set(
        self,
        name: str,
        value: ParameterValue,
        evidence: Evidence,
        uncertainty: Uncertainty = Uncertainty.NONE,
        *,
        argument: str = "",
    ) -> None:
        """Set a parameter in a place of the launch, or to the default that an argument has there.

        Where conditions around it are not known, a name with two different values has no known
        one; where its own condition is not known, it has none. Raise UnresolvableError past
        MAX_SET.
        """
        self._count_parameter()
        key = anonymous_to_wildcard(canonical_name(name))
        earlier = self._set.get(key)
        contradicts = earlier is not None and earlier.value != value
        if uncertainty is Uncertainty.OWN or (uncertainty is Uncertainty.INHERITED and contradicts):
            value = _UNCERTAIN_VALUE
        self._set[key] = Parameter(value=value, evidence=evidence)
        setter, self._setters[key] = self._setters.get(key, ""), "".join(self.files[-1:])
        self.overridden.pop(key, None)
        if earlier is not None and setter in self.files[:-1]:
            self._note_overridden(key, earlier, self._set[key], argument)

    def _note_overridden(
        self, name: str, earlier: Parameter, later: Parameter, argument: str
    ) -> None:
        """Note what a file sets to one plain value, and one that it includes later to another."""
        values = earlier.value, later.value
        if values[0] != values[1] and all(isinstance(each, _PLAIN) for each in values):
            one, other = map(str, values)
            self.overridden[name] = WiringFact(
                kind=WiringFactKind.OVERRIDDEN_PARAMETER,
                subject=name,
                value=other[:_SHOWN],
                others=(one[:_SHOWN], *filter(None, [argument])),
                evidence=(earlier.evidence, later.evidence),
            )

    def set_by_node(self, name: str, parameter: Parameter) -> None:
        """Set a parameter when all others are set, as a node does; raise as `set` does."""
        self._count_parameter()
        self._set_by_nodes.append((name, parameter))

    def _count_parameter(self) -> None:
        self._count += 1
        if self._count > MAX_PARAMETERS:
            raise UnresolvableError(
                f"not set: the launch sets {MAX_PARAMETERS} parameters without it"
            )

    def clear(self, namespace: str, uncertainty: Uncertainty) -> None:
        """Clear all below a namespace, if that is sure; what this launch sets comes after."""
        if not uncertainty:
            self.cleared.append(anonymous_to_wildcard(namespace))

    def set_unknown(self, namespace: str, why: str, evidence: Evidence) -> None:
        """Say that what a file would set below a namespace is not known."""
        key = anonymous_to_wildcard(resolve_name(namespace, _SETTING_NODE))
        self._unknown[key] = Parameter(value=UnknownValue(why), evidence=evidence)

    def apply(self, server: ParameterServer) -> None:
        """Do to a server what roslaunch does to it."""
        for name in (*self.deleted, *self.cleared):
            server.delete(name)
        for name, parameter in (*self._set.items(), *self._set_by_nodes):
            server.set(resolve_name(name, _SETTING_NODE), parameter)
        for name, parameter in self._unknown.items():
            if not server.has_below(name):
                server.set(name, parameter)


def _name_parts(name: str) -> list[str]:
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


MAX_BYTES = 8 * 1024 * 1024
MAX_TOTAL_BYTES = 4 * MAX_BYTES


@dataclass(slots=True)
class LaunchFileCache:
    """Files of some launches: launch and YAML files are parsed once, however often named.

    With `roots`, only what lies in these folders is read, links followed: a stranger's launch file
    must not show what else is on this machine.
    """

    roots: tuple[Path, ...] | None = None
    _launches: dict[str, LaunchDocument] = field(default_factory=dict)
    _yamls: dict[str, YamlFile] = field(default_factory=dict)
    _bytes_read: int = 0

    def launch(self, path: str) -> LaunchDocument:
        """Return a parsed launch file; raise InputError."""
        if path not in self._launches:
            self._check_roots(path)
            self._launches[path] = parse_launch(path)
        return self._launches[path]

    def yaml(self, path: str) -> YamlFile:
        """Return a parsed YAML file; raise InputError."""
        if path not in self._yamls:
            self._yamls[path] = parse_yaml(self.text(path), path)
        return self._yamls[path]

    def text(self, path: str) -> str:
        """Return a text file's content with Python's line ends; raise InputError."""
        try:
            text = self.data(path).decode("utf-8")
        except UnicodeDecodeError:
            raise InputError("not UTF-8 text", path=path) from None
        return text.replace("\r\n", "\n").replace("\r", "\n")

    def data(self, path: str) -> bytes:
        """Return a plain file's content; raise InputError if it is none or all are too large."""
        file = Path(path)
        self._check_roots(path)
        if not path_exists(file) or not file.is_file():
            raise InputError("no such file", path=path, help="check the path")
        data = read_bounded(file, MAX_BYTES)
        self._bytes_read += len(data)
        if self._bytes_read > MAX_TOTAL_BYTES:
            mebibytes = MAX_TOTAL_BYTES // 2**20
            raise InputError(f"not read: the launch reads {mebibytes} MiB without it", path=path)
        return data

    def _check_roots(self, path: str) -> None:
        if self.roots is None:
            return
        real = Path(path).resolve()
        if not any(real.is_relative_to(root) for root in self.roots):
            help = "if it belongs to the app, give its folder too"
            raise InputError("lies outside of the folders that are read", path=path, help=help)


@dataclass(slots=True, kw_only=True)
class LoadState:
    """What is common to all files of one launch.

    `include_count` counts the includes so far, `element_count` those of the included files.
    """

    packages: PackageIndex
    environ: Mapping[str, str]
    describe: DescribeRobot | None = None
    documents: LaunchFileCache = field(default_factory=LaunchFileCache)
    parameters: LaunchParameters = field(default_factory=LaunchParameters)
    unresolved: UnresolvedNotes = field(default_factory=UnresolvedNotes)
    remaps_behind_all: list[LaunchRemap] = field(default_factory=list)
    declared_arguments: set[str] = field(default_factory=set)
    include_count: int = 0
    element_count: int = 0
