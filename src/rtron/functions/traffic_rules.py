"""What a node's messages tell of its function: rules over what it publishes and subscribes."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from rtron.functions.interactions.typical_messages import (
    TypicalTraffic,
    is_informative,
    typical_traffic,
)
from rtron.functions.repository import load_package_yaml
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
            (not self.publishes or _any_matches(traffic.publishes, self.publishes))
            and (not self.publishes_only or _only_matches(traffic.publishes, self.publishes_only))
            and (not self.subscribes or self._matches_subscriptions(traffic.subscribes))
            and not _any_matches(traffic.subscribes, self.not_subscribes)
            and not _any_matches(traffic.publishes | traffic.subscribes, self.without)
        )

    def _matches_subscriptions(self, types: frozenset[str]) -> bool:
        if self.subscribes == (_NOTHING,):
            return not any(map(is_informative, types))
        return _any_matches(types, self.subscribes)


def node_traffic(graph: InteractionGraph) -> Mapping[str, NodeTraffic]:
    """Return what each node of a graph publishes and subscribes itself."""
    client_types, server_types = (
        _actions(graph, ActionRole.CLIENT),
        _actions(graph, ActionRole.SERVER),
    )
    return {
        node.name: NodeTraffic(
            publishes=_types(graph.published_by(node.name)) | client_types[node.name],
            subscribes=_types(graph.subscribed_by(node.name)) | server_types[node.name],
        )
        for node in graph.nodes
    }


def functions_by_messages(traffic: NodeTraffic) -> tuple[FunctionType, ...]:
    """Return the functions that the messages tell: of the one rule that fits, else none."""
    matching = [rule.functions for rule in _message_rules() if rule.fits(traffic)]
    return matching[0] if len(matching) == 1 else ()


def filter_plausible(
    functions: Iterable[FunctionType], traffic: NodeTraffic
) -> tuple[FunctionType, ...]:
    """Return those of a name's functions that a node with these messages may have.

    Where nothing is known of its messages, nothing is ruled out.
    """
    is_known = traffic != NodeTraffic()
    return tuple(
        f
        for f in functions
        if not is_known or f not in _driver_rules() or _driver_rules()[f].fits(traffic)
    )


def has_typical_traffic(function: FunctionType, traffic: NodeTraffic) -> bool:
    """Tell whether a node publishes or subscribes something that is typical of a function."""
    typical = _typical_traffic(function)
    published, subscribed = (
        typical.publishes & traffic.publishes,
        typical.subscribes & traffic.subscribes,
    )
    return bool(published or subscribed)


def publishes_typical(function: FunctionType, traffic: NodeTraffic) -> bool:
    """Tell whether a node publishes something that is typical of a function."""
    return not _typical_traffic(function).publishes.isdisjoint(traffic.publishes)


@cache
def _typical_traffic(function: FunctionType) -> TypicalTraffic:
    """Return what is typical of a function, and of its subfunctions."""
    names = [function.value]
    if function is FunctionType.RECOGNITION:
        names += [subfunction.value for subfunction in RecognitionSubfunction]
    traffic = [typical_traffic().get(name, TypicalTraffic()) for name in names]
    return TypicalTraffic(
        publishes=frozenset().union(*(each.publishes for each in traffic)),
        subscribes=frozenset().union(*(each.subscribes for each in traffic)),
    )


@cache
def _driver_rules() -> Mapping[FunctionType, TrafficRule]:
    entries = load_package_yaml("rtron.functions", "nodes.yaml")["drivers"]
    rules = [parse_traffic_rule([entry["function"]], entry) for entry in entries]
    return {rule.functions[0]: rule for rule in rules}


@cache
def _message_rules() -> tuple[TrafficRule, ...]:
    entries = load_package_yaml("rtron.functions", "nodes.yaml")["messages"]
    return tuple(parse_traffic_rule(entry["functions"], entry) for entry in entries)


def parse_traffic_rule(functions: Iterable[str], entry: Mapping[str, Any]) -> TrafficRule:
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


def _any_matches(types: Iterable[str], patterns: tuple[str, ...]) -> bool:
    return any(fnmatchcase(type, pattern) for type in types for pattern in patterns)


def _only_matches(types: Iterable[str], patterns: tuple[str, ...]) -> bool:
    informative = [type for type in types if is_informative(type)]
    return bool(informative) and all(_any_matches([type], patterns) for type in informative)
