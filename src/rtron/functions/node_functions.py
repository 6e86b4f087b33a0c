"""The functions of the nodes of an app: by what is known of them, their names, their messages.

A node of a well-known package is known. Else its package tells, by name and description, its own
name, and its messages. Pieces that agree decide; where they do not, the node stays unknown: a wrong
function is worse than none.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import chain
from typing import Any, TypeAlias

from rtron.functions.classifier.pipeline import classify_name
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.functions.repository import load_package_yaml
from rtron.functions.traffic_rules import (
    NodeTraffic,
    filter_plausible,
    functions_by_messages,
    has_typical_traffic,
    node_traffic,
)
from rtron.vocabulary import Domain, FunctionType, InteractionGraph, Node, StringEnum

Functions: TypeAlias = tuple[FunctionType, ...]
_NO_DESCRIPTIONS: Mapping[str, str] = {}
_WORD = re.compile(r"[a-z0-9]+")
_NUMBERED = re.compile(r"_[0-9]+\Z")
_ACTUATORS = frozenset({FunctionType.MOBILE, FunctionType.MANIPULATOR})
_VAGUE = frozenset({FunctionType.SUPPORT, FunctionType.EXTENSION})


class FunctionSource(StringEnum):
    """What tells a node's function, the surest first; `conflict`: the pieces do not agree."""

    DECLARED = "given"
    KNOWN = "known"
    PACKAGE = "package"
    NAME = "name"
    MESSAGES = "messages"
    CONFLICT = "conflict"
    NOTHING = "nothing"


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeFunctions:
    """The functions of a node, and their source; the first one is the node's own where certain.

    `is_certain` is false where a package has several functions and nothing says which of them the
    node has.
    """

    functions: Functions = ()
    source: FunctionSource = FunctionSource.NOTHING
    is_certain: bool = True

    @property
    def function(self) -> FunctionType | None:
        """The one function of the node, if there is one."""
        return self.functions[0] if self.functions and self.is_certain else None

    @property
    def domain(self) -> Domain | None:
        """The domain of all its functions, if it is one."""
        domains = {DOMAIN_BY_TYPE[function] for function in self.functions}
        return DOMAIN_BY_TYPE[self.functions[0]] if self.function or len(domains) == 1 else None


def with_functions(
    graph: InteractionGraph, descriptions: Mapping[str, str] = _NO_DESCRIPTIONS
) -> InteractionGraph:
    """Return the graph with the function and domain of its nodes, where these are known.

    `descriptions` are those of the packages' manifests. A function that stands there stays.
    """
    functions = functions_of_nodes(graph, descriptions)
    return replace(
        graph, nodes=tuple(_with_function(node, functions[node.name]) for node in graph.nodes)
    )


def functions_of_nodes(
    graph: InteractionGraph, descriptions: Mapping[str, str] = _NO_DESCRIPTIONS
) -> Mapping[str, NodeFunctions]:
    """Return the functions of each node by its name."""
    traffic, classifier = node_traffic(graph), _NameClassifier(descriptions=descriptions)
    return {n.name: _node_functions(n, traffic[n.name], classifier) for n in graph.nodes}


@dataclass(slots=True, kw_only=True)
class _NameClassifier:
    """What names tell, each asked once: the nodes of an app share packages and programs."""

    descriptions: Mapping[str, str]
    _cache: dict[tuple[str, str], Functions] = field(default_factory=dict)

    def by_name(self, name: str, description: str = "") -> Functions:
        key = (name, description)
        if key not in self._cache:
            self._cache[key] = classify_name(name, description)
        return self._cache[key]

    def by_package(self, package: str) -> Functions:
        return self.by_name(package, self.descriptions.get(package, ""))


def _with_function(node: Node, functions: NodeFunctions) -> Node:
    return replace(node, function=functions.function, domain=node.domain or functions.domain)


def _node_functions(node: Node, traffic: NodeTraffic, classifier: _NameClassifier) -> NodeFunctions:
    """Return a node's functions: the one that is given, and others where they fit to it."""
    inferred = _infer_functions(node, traffic, classifier)
    if node.function is None:
        return inferred
    fitting = inferred.functions if node.function in inferred.functions else ()
    others = (each for each in fitting if each is not node.function)
    return NodeFunctions(functions=(node.function, *others), source=FunctionSource.DECLARED)


def _infer_functions(
    node: Node, traffic: NodeTraffic, classifier: _NameClassifier
) -> NodeFunctions:
    known_functions = _known_functions(node)
    if known_functions:
        return NodeFunctions(functions=known_functions, source=FunctionSource.KNOWN)
    return combine_sources(
        {
            FunctionSource.PACKAGE: _by_package(node, traffic, classifier),
            FunctionSource.NAME: _by_name(_program_name(node), traffic, classifier),
            FunctionSource.MESSAGES: functions_by_messages(traffic),
        }
    )


def combine_sources(functions_by_source: Mapping[FunctionSource, Functions]) -> NodeFunctions:
    """Return what pieces of evidence agree on, the surest of them first.

    Support and Extension, which fit whatever is built for ROS, count only where nothing else
    tells. What two pieces say stands against a third.
    """
    conclusive = {
        source: functions
        for source, functions in functions_by_source.items()
        if set(functions) - _VAGUE
    }
    conclusive = conclusive or {
        source: functions for source, functions in functions_by_source.items() if functions
    }
    if not conclusive:
        return NodeFunctions()
    common = _common_functions(list(conclusive.values()))
    if not common:
        return NodeFunctions(source=FunctionSource.CONFLICT)
    source = next(
        source for source, functions in conclusive.items() if set(common) <= set(functions)
    )
    is_certain = len(common) == 1 or source is FunctionSource.MESSAGES
    return NodeFunctions(functions=common, source=source, is_certain=is_certain)


def _common_functions(functions: Sequence[Functions]) -> Functions:
    """Return what all pieces say, else what two of them do, in the order of the first."""
    pairs = [(a, b) for i, a in enumerate(functions) for b in functions[i + 1 :]]
    for group in (functions, *(pairs if len(functions) > 2 else ())):  # noqa: PLR2004 - two of three
        shared = frozenset(group[0]).intersection(*group[1:])
        if shared:
            return tuple(function for function in group[0] if function in shared)
    return ()


def _by_package(node: Node, traffic: NodeTraffic, classifier: _NameClassifier) -> Functions:
    """Return what the node's package tells; of several functions those that its messages fit."""
    if not node.package or node.package in _launcher_packages():
        return ()
    named = classifier.by_package(node.package)
    matching = filter_plausible(named, traffic)
    is_ambiguous = len(named) > 1 and traffic != NodeTraffic()
    return (
        tuple(f for f in matching if has_typical_traffic(f, traffic)) if is_ambiguous else matching
    )


def _by_name(name: str, traffic: NodeTraffic, classifier: _NameClassifier) -> Functions:
    """Return what a node's own name tells, where its messages are of that kind.

    Where they are not known, as of a nodelet's loader, a robot's name makes no driver of it.
    """
    words = frozenset(_WORD.findall(name.lower()))
    by_words = [functions for functions, keywords in _name_words() if words & keywords]
    candidates = dict.fromkeys((*chain.from_iterable(by_words), *classifier.by_name(name)))
    if traffic == NodeTraffic():
        return tuple(f for f in candidates if f not in _ACTUATORS)
    return filter_plausible([f for f in candidates if has_typical_traffic(f, traffic)], traffic)


def _program_name(node: Node) -> str:
    """Return the name of the node's program, or of the node without its number."""
    if node.executable and node.package not in _launcher_packages():
        return node.executable.partition(".")[0]
    return _NUMBERED.sub("", node.name.rpartition("/")[2])


def _known_functions(node: Node) -> Functions:
    """Return what is known of the node's package, or of a node of that name without a package."""
    is_anonymous = not node.package or node.package in _launcher_packages()
    lookup_name = node.name.rpartition("/")[2] if is_anonymous else node.package
    programs = frozenset({node.executable, node.name.rpartition("/")[2]})
    entries = _known_packages().get(lookup_name, ())
    fitting = (
        functions for functions, executables in entries if not executables or programs & executables
    )
    return next(fitting, ())


@cache
def _known_packages() -> Mapping[str, Sequence[tuple[Functions, frozenset[str]]]]:
    functions_by_package: dict[str, list[tuple[Functions, frozenset[str]]]] = {}
    for entry in _data()["known"]:
        functions = tuple(map(FunctionType, entry["functions"]))
        executables = frozenset(entry.get("executables", ()))
        for package in entry["packages"]:
            functions_by_package.setdefault(package, []).append((functions, executables))
    return functions_by_package


@cache
def _name_words() -> Sequence[tuple[Functions, frozenset[str]]]:
    entries = _data()["words"]
    return [(tuple(map(FunctionType, e["functions"])), frozenset(e["words"])) for e in entries]


@cache
def _launcher_packages() -> frozenset[str]:
    return frozenset(_data()["carriers"])


def _data() -> Mapping[str, Any]:
    data: Mapping[str, Any] = load_package_yaml("rtron.functions", "nodes.yaml")
    return data
