"""What nodes have, as pairs of node and name: the unit in which an architecture is scored."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import yaml

from rtron.vocabulary import Direction, InteractionGraph, Resolution

Pair: TypeAlias = tuple[str, str]
Pairs: TypeAlias = frozenset[Pair]

IGNORED = frozenset({"/clock", "/tf", "/tf_static", "/diagnostics"})
IGNORED_ENDINGS = (
    "/load_nodelet",
    "/unload_nodelet",
    "/bond",
    "/list_controllers",
    "/parameter_descriptions",
    "/parameter_description",
    "/parameter_updates",
    "/set_parameters",
    "manager/list",
)
"""The names that ROSDiscover's comparison leaves out (its evaluation's README, 13 patterns)."""
UNOBSERVED = ("/rosout", "/rosout_agg")
UNOBSERVED_ENDINGS = ("/get_loggers", "/set_logger_level")
"""What every node has by its client library, and the observer does not write down."""

_ANSWERS = ("feedback", "result", "status")
_ORDERS = ("goal", "cancel")


@dataclass(frozen=True, slots=True, kw_only=True)
class Architecture:
    """The nodes of a system, and the pairs of each kind; an action is one pair on each side."""

    nodes: Pairs = frozenset()
    publishers: Pairs = frozenset()
    subscribers: Pairs = frozenset()
    services: Pairs = frozenset()
    action_servers: Pairs = frozenset()
    action_clients: Pairs = frozenset()


KINDS = ("nodes", "publishers", "subscribers", "services", "action_servers", "action_clients")


def read_architecture(path: Path) -> Architecture:
    """Return the architecture in a YAML file of ROSDiscover, nothing left out or folded."""
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    nodes = document["nodes"] if isinstance(document, dict) else document
    return Architecture(
        nodes=frozenset((node["fullname"], node["fullname"]) for node in nodes),
        publishers=_listed(nodes, "pubs"),
        subscribers=_listed(nodes, "subs"),
        services=_listed(nodes, "provides"),
        action_servers=_listed(nodes, "action-servers"),
        action_clients=_listed(nodes, "action-clients"),
    )


def graph_architecture(graph: InteractionGraph) -> Architecture:
    """Return a graph's architecture; symbolic names and what no observer writes are left out."""
    endpoints = [e for e in graph.endpoints if e.resolution is not Resolution.SYMBOLIC]
    published = ((e.node, e.topic) for e in endpoints if e.direction is Direction.PUBLISH)
    subscribed = ((e.node, e.topic) for e in endpoints if e.direction is Direction.SUBSCRIBE)
    services = ((s.node, s.name) for s in graph.services if "{" not in s.name)
    return Architecture(
        nodes=frozenset((node.name, node.name) for node in graph.nodes),
        publishers=_observed(published),
        subscribers=_observed(subscribed),
        services=_observed(services),
    )


def without_ignored(architecture: Architecture) -> Architecture:
    """Return what the ignore list leaves of the topics and services."""
    return _filtered(architecture, lambda pair: not is_ignored(pair[1]))


def without_nodes(architecture: Architecture, names: Iterable[str]) -> Architecture:
    """Return an architecture without some nodes."""
    removed = frozenset(names)
    remaining = _filtered(architecture, lambda pair: pair[0] not in removed)
    return replace(
        remaining, nodes=frozenset(pair for pair in remaining.nodes if pair[0] not in removed)
    )


def is_ignored(name: str) -> bool:
    """Tell whether the ignore list has a name."""
    return name in IGNORED or name.endswith(IGNORED_ENDINGS)


def with_actions(architecture: Architecture) -> Architecture:
    """Return the architecture with the five topics of each action as one pair.

    Where no action is declared, they are known by their topics (actionlib).
    """
    a = architecture
    servers, clients = a.action_servers, a.action_clients
    if not servers and not clients:
        servers = _sides(answers=a.publishers, orders=a.subscribers)
        clients = _sides(answers=a.subscribers, orders=a.publishers)
    return replace(
        a,
        publishers=a.publishers - _parts(servers, _ANSWERS) - _parts(clients, _ORDERS),
        subscribers=a.subscribers - _parts(servers, _ORDERS) - _parts(clients, _ANSWERS),
        action_servers=servers,
        action_clients=clients,
    )


def _sides(*, answers: Pairs, orders: Pairs) -> Pairs:
    spaces = {(node, name.removesuffix("/feedback")) for node, name in answers}
    return frozenset(
        space
        for space in spaces
        if _parts({space}, _ANSWERS) <= answers and _parts({space}, _ORDERS) <= orders
    )


def _parts(actions: Iterable[Pair], names: Iterable[str]) -> Pairs:
    parts = tuple(names)
    return frozenset((node, f"{action}/{part}") for node, action in actions for part in parts)


def _listed(nodes: Iterable[Mapping[str, Any]], key: str) -> Pairs:
    return frozenset(
        (node["fullname"], entry["name"]) for node in nodes for entry in node.get(key) or ()
    )


def _observed(pairs: Iterable[Pair]) -> Pairs:
    return frozenset(
        pair
        for pair in pairs
        if pair[1] not in UNOBSERVED and not pair[1].endswith(UNOBSERVED_ENDINGS)
    )


def _filtered(architecture: Architecture, is_included: Callable[[Pair], bool]) -> Architecture:
    return replace(
        architecture,
        publishers=frozenset(filter(is_included, architecture.publishers)),
        subscribers=frozenset(filter(is_included, architecture.subscribers)),
        services=frozenset(filter(is_included, architecture.services)),
    )


@dataclass(frozen=True, slots=True)
class Score:
    """What was observed and what was recovered, of one kind."""

    observed: Pairs
    recovered: Pairs

    @property
    def hits(self) -> int:
        """Return how many pairs were observed and recovered."""
        return len(self.observed & self.recovered)

    @property
    def precision(self) -> float:
        """Return the share of the recovered pairs that were observed; 1 if none was recovered."""
        return self.hits / len(self.recovered) if self.recovered else 1.0

    @property
    def recall(self) -> float:
        """Return the share of the observed pairs that were recovered; 1 if none was observed."""
        return self.hits / len(self.observed) if self.observed else 1.0

    def differences(self) -> Iterator[str]:
        """Yield a line for each pair that was missed or invented."""
        for word, pairs in (
            ("MISSED", self.observed - self.recovered),
            ("EXTRA", self.recovered - self.observed),
        ):
            yield from (f"{word:6} {node} {name}" for node, name in sorted(pairs))


def score(observed: Architecture, recovered: Architecture, *, raw: bool) -> Mapping[str, Score]:
    """Return the score of each kind, with nothing ignored if `raw`."""
    if not raw:
        observed, recovered = without_ignored(observed), without_ignored(recovered)
    observed_pairs, found = with_actions(observed), with_actions(recovered)
    return {kind: Score(getattr(observed_pairs, kind), getattr(found, kind)) for kind in KINDS}
