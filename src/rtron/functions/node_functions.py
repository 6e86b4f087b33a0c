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
from rtron.functions.domains import DOMAIN_OF
from rtron.functions.package_data import shipped
from rtron.functions.traffic_rules import (
    NodeTraffic,
    functions_by_messages,
    node_traffic,
    plausible,
    speaks_like,
)
from rtron.vocabulary import Domain, FunctionType, InteractionGraph, Node, Word

Functions: TypeAlias = tuple[FunctionType, ...]
_NO_DESCRIPTIONS: Mapping[str, str] = {}
_WORD = re.compile(r"[a-z0-9]+")
_NUMBERED = re.compile(r"_[0-9]+\Z")
_ACTUATORS = frozenset({FunctionType.MOBILE, FunctionType.MANIPULATOR})
_VAGUE = frozenset({FunctionType.SUPPORT, FunctionType.EXTENSION})


class ToldBy(Word):
    """What tells a node's function, the surest first; `conflict`: the pieces do not agree."""

    GIVEN = "given"
    KNOWN = "known"
    PACKAGE = "package"
    NAME = "name"
    MESSAGES = "messages"
    CONFLICT = "conflict"
    NOTHING = "nothing"


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeFunctions:
    """The functions of a node, and what tells them; the first one is the node's own where sure.

    `sure` is false where a package has several functions and nothing tells which is the node's.
    """

    functions: Functions = ()
    told_by: ToldBy = ToldBy.NOTHING
    sure: bool = True

    @property
    def function(self) -> FunctionType | None:
        """The one function of the node, if there is one."""
        return self.functions[0] if self.functions and self.sure else None

    @property
    def domain(self) -> Domain | None:
        """The domain of all its functions, if it is one."""
        found = {DOMAIN_OF[function] for function in self.functions}
        return DOMAIN_OF[self.functions[0]] if self.function or len(found) == 1 else None


def with_functions(
    graph: InteractionGraph, descriptions: Mapping[str, str] = _NO_DESCRIPTIONS
) -> InteractionGraph:
    """Return the graph with the function and domain of its nodes, where these are known.

    `descriptions` are those of the packages' manifests. A function that stands there stays.
    """
    found = functions_of_nodes(graph, descriptions)
    return replace(graph, nodes=tuple(_with(node, found[node.name]) for node in graph.nodes))


def functions_of_nodes(
    graph: InteractionGraph, descriptions: Mapping[str, str] = _NO_DESCRIPTIONS
) -> Mapping[str, NodeFunctions]:
    """Return the functions of each node by its name."""
    traffic, told = node_traffic(graph), _Told(descriptions=descriptions)
    return {n.name: _functions(n, traffic[n.name], told) for n in graph.nodes}


@dataclass(slots=True, kw_only=True)
class _Told:
    """What names tell, each asked once: the nodes of an app share packages and programs."""

    descriptions: Mapping[str, str]
    _known: dict[tuple[str, str], Functions] = field(default_factory=dict)

    def by(self, name: str, description: str = "") -> Functions:
        key = (name, description)
        if key not in self._known:
            self._known[key] = classify_name(name, description)
        return self._known[key]

    def by_package(self, package: str) -> Functions:
        return self.by(package, self.descriptions.get(package, ""))


def _with(node: Node, found: NodeFunctions) -> Node:
    return replace(node, function=found.function, domain=node.domain or found.domain)


def _functions(node: Node, traffic: NodeTraffic, told: _Told) -> NodeFunctions:
    """Return a node's functions: the one that is given, and others where they fit to it."""
    found = _found(node, traffic, told)
    if node.function is None:
        return found
    fitting = found.functions if node.function in found.functions else ()
    others = (each for each in fitting if each is not node.function)
    return NodeFunctions(functions=(node.function, *others), told_by=ToldBy.GIVEN)


def _found(node: Node, traffic: NodeTraffic, told: _Told) -> NodeFunctions:
    known = _known_functions(node)
    if known:
        return NodeFunctions(functions=known, told_by=ToldBy.KNOWN)
    return agreed(
        {
            ToldBy.PACKAGE: _by_package(node, traffic, told),
            ToldBy.NAME: _by_name(_own_name(node), traffic, told),
            ToldBy.MESSAGES: functions_by_messages(traffic),
        }
    )


def agreed(pieces: Mapping[ToldBy, Functions]) -> NodeFunctions:
    """Return what pieces of evidence agree on, the surest of them first.

    Support and Extension, which fit whatever is built for ROS, count only where nothing else
    tells. What two pieces say stands against a third.
    """
    telling = {by: functions for by, functions in pieces.items() if set(functions) - _VAGUE}
    telling = telling or {by: functions for by, functions in pieces.items() if functions}
    if not telling:
        return NodeFunctions()
    common = _common(list(telling.values()))
    if not common:
        return NodeFunctions(told_by=ToldBy.CONFLICT)
    by = next(by for by, functions in telling.items() if set(common) <= set(functions))
    sure = len(common) == 1 or by is ToldBy.MESSAGES
    return NodeFunctions(functions=common, told_by=by, sure=sure)


def _common(told: Sequence[Functions]) -> Functions:
    """Return what all pieces say, else what two of them do, in the order of the first."""
    pairs = [(a, b) for i, a in enumerate(told) for b in told[i + 1 :]]
    for group in (told, *(pairs if len(told) > 2 else ())):  # noqa: PLR2004 - two of three
        shared = frozenset(group[0]).intersection(*group[1:])
        if shared:
            return tuple(function for function in group[0] if function in shared)
    return ()


def _by_package(node: Node, traffic: NodeTraffic, told: _Told) -> Functions:
    """Return what the node's package tells; of several functions those that its messages fit."""
    if not node.package or node.package in _carriers():
        return ()
    tells = told.by_package(node.package)
    found = plausible(tells, traffic)
    several = len(tells) > 1 and traffic != NodeTraffic()
    return tuple(f for f in found if speaks_like(f, traffic)) if several else found


def _by_name(name: str, traffic: NodeTraffic, told: _Told) -> Functions:
    """Return what a node's own name tells, where its messages are of that kind.

    Where they are not known, as of a nodelet's loader, a robot's name makes no driver of it.
    """
    words = frozenset(_WORD.findall(name.lower()))
    by_words = [functions for functions, known in _words() if words & known]
    found = dict.fromkeys((*chain.from_iterable(by_words), *told.by(name)))
    if traffic == NodeTraffic():
        return tuple(f for f in found if f not in _ACTUATORS)
    return plausible([f for f in found if speaks_like(f, traffic)], traffic)


def _own_name(node: Node) -> str:
    """Return the name of the node's program, or of the node without its number."""
    if node.executable and node.package not in _carriers():
        return node.executable.partition(".")[0]
    return _NUMBERED.sub("", node.name.rpartition("/")[2])


def _known_functions(node: Node) -> Functions:
    """Return what is known of the node's package, or of a node of that name without a package."""
    carried = not node.package or node.package in _carriers()
    named = node.name.rpartition("/")[2] if carried else node.package
    programs = frozenset({node.executable, node.name.rpartition("/")[2]})
    entries = _known().get(named, ())
    fitting = (its for its, executables in entries if not executables or programs & executables)
    return next(fitting, ())


@cache
def _known() -> Mapping[str, Sequence[tuple[Functions, frozenset[str]]]]:
    found: dict[str, list[tuple[Functions, frozenset[str]]]] = {}
    for entry in _data()["known"]:
        functions = tuple(map(FunctionType, entry["functions"]))
        executables = frozenset(entry.get("executables", ()))
        for package in entry["packages"]:
            found.setdefault(package, []).append((functions, executables))
    return found


@cache
def _words() -> Sequence[tuple[Functions, frozenset[str]]]:
    entries = _data()["words"]
    return [(tuple(map(FunctionType, e["functions"])), frozenset(e["words"])) for e in entries]


@cache
def _carriers() -> frozenset[str]:
    return frozenset(_data()["carriers"])


def _data() -> Mapping[str, Any]:
    data: Mapping[str, Any] = shipped("rtron.functions", "nodes.yaml")
    return data
