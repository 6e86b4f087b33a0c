"""What a node's messages tell of its function: rules over what it publishes and subscribes."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from rtron.functions.interactions.typical_messages import Traffic, says_something, typical
from rtron.functions.package_data import shipped
from rtron.vocabulary import (
    ActionRole,
    Endpoint,
    FunctionType,
    InteractionGraph,
    RecognitionSubfunction,
    is_action_type,
    normalise_type,
)

_NOTHING = "nothing"


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeTraffic:
    """The message types that a node publishes and subscribes, in ROS 1 spelling.

    A client of an action publishes its type, a server subscribes it.
    """

    publishes: frozenset[str] = frozenset()
    subscribes: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class TrafficRule:
    """Patterns of message types: one of each given kind must be there; see `nodes.yaml`."""

    functions: tuple[FunctionType, ...]
    publishes: tuple[str, ...] = ()
    publishes_only: tuple[str, ...] = ()
    subscribes: tuple[str, ...] = ()
    not_subscribes: tuple[str, ...] = ()
    without: tuple[str, ...] = ()

    def fits(self, traffic: NodeTraffic) -> bool:
        """Tell whether a node with this traffic is one that the rule means."""
        return (
            (not self.publishes or _any(traffic.publishes, self.publishes))
            and (not self.publishes_only or _only(traffic.publishes, self.publishes_only))
            and (not self.subscribes or self._hears(traffic.subscribes))
            and not _any(traffic.subscribes, self.not_subscribes)
            and not _any(traffic.publishes | traffic.subscribes, self.without)
        )

    def _hears(self, types: frozenset[str]) -> bool:
        if self.subscribes == (_NOTHING,):
            return not any(map(says_something, types))
        return _any(types, self.subscribes)


def node_traffic(graph: InteractionGraph) -> Mapping[str, NodeTraffic]:
    """Return what each node of a graph publishes and subscribes itself."""
    asked, served = _actions(graph, ActionRole.CLIENT), _actions(graph, ActionRole.SERVER)
    return {
        node.name: NodeTraffic(
            publishes=_types(graph.published_by(node.name)) | asked[node.name],
            subscribes=_types(graph.subscribed_by(node.name)) | served[node.name],
        )
        for node in graph.nodes
    }


def functions_by_messages(traffic: NodeTraffic) -> tuple[FunctionType, ...]:
    """Return the functions that the messages tell: of the one rule that fits, else none."""
    found = [rule.functions for rule in _rules() if rule.fits(traffic)]
    return found[0] if len(found) == 1 else ()


def plausible(functions: Iterable[FunctionType], traffic: NodeTraffic) -> tuple[FunctionType, ...]:
    """Return those of a name's functions that a node with these messages may have.

    Where nothing is known of its messages, nothing is ruled out.
    """
    known = traffic != NodeTraffic()
    return tuple(
        f for f in functions if not known or f not in _drivers() or _drivers()[f].fits(traffic)
    )


def speaks_like(function: FunctionType, traffic: NodeTraffic) -> bool:
    """Tell whether a node publishes or subscribes something that is typical of a function."""
    usual = _usual(function)
    sent, heard = usual.publishes & traffic.publishes, usual.subscribes & traffic.subscribes
    return bool(sent or heard)


def says_like(function: FunctionType, traffic: NodeTraffic) -> bool:
    """Tell whether a node publishes something that is typical of a function."""
    return not _usual(function).publishes.isdisjoint(traffic.publishes)


@cache
def _usual(function: FunctionType) -> Traffic:
    """Return what is typical of a function, and of its subfunctions."""
    names = [function.value]
    if function is FunctionType.RECOGNITION:
        names += [subfunction.value for subfunction in RecognitionSubfunction]
    found = [typical().get(name, Traffic()) for name in names]
    return Traffic(
        publishes=frozenset().union(*(each.publishes for each in found)),
        subscribes=frozenset().union(*(each.subscribes for each in found)),
    )


@cache
def _drivers() -> Mapping[FunctionType, TrafficRule]:
    entries = shipped("rtron.functions", "nodes.yaml")["drivers"]
    rules = [rule_of([entry["function"]], entry) for entry in entries]
    return {rule.functions[0]: rule for rule in rules}


@cache
def _rules() -> tuple[TrafficRule, ...]:
    entries = shipped("rtron.functions", "nodes.yaml")["messages"]
    return tuple(rule_of(entry["functions"], entry) for entry in entries)


def rule_of(functions: Iterable[str], entry: Mapping[str, Any]) -> TrafficRule:
    """Return the rule of an entry in `nodes.yaml`."""
    return TrafficRule(
        functions=tuple(map(FunctionType, functions)),
        publishes=tuple(entry.get("publishes", ())),
        publishes_only=tuple(entry.get("publishes_only", ())),
        subscribes=tuple(entry.get("subscribes", ())),
        not_subscribes=tuple(entry.get("not_subscribes", ())),
        without=tuple(entry.get("without", ())),
    )


def _actions(graph: InteractionGraph, role: ActionRole) -> Mapping[str, set[str]]:
    types: dict[str, set[str]] = defaultdict(set)
    for action in graph.actions:
        if action.role is role and action.type:
            types[action.node].add(_goal_type(action.type))
    return types


def _goal_type(type: str) -> str:
    """Return the type of an action's goals in ROS 1; in ROS 2 the action's own."""
    return type if is_action_type(type) else f"{type}Goal"


def _types(endpoints: Iterable[Endpoint]) -> frozenset[str]:
    return frozenset(normalise_type(e.type) for e in endpoints if e.type and not e.implicit)


def _any(types: Iterable[str], patterns: tuple[str, ...]) -> bool:
    return any(fnmatchcase(type, pattern) for type in types for pattern in patterns)


def _only(types: Iterable[str], patterns: tuple[str, ...]) -> bool:
    telling = [type for type in types if says_something(type)]
    return bool(telling) and all(_any([type], patterns) for type in telling)
