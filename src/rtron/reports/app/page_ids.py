"""Ids of the nodes and topics of a page: names come from strangers, ids do not."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rtron.vocabulary import (
    EventFlow,
    GuardedTopic,
    InteractionGraph,
    Plan,
    RiskReport,
    WatchedFlow,
    matches_node,
)


@dataclass(frozen=True, slots=True)
class PageIds:
    """The number of each node and each topic, in the order of the page's lists."""

    nodes: dict[str, int]
    topics: dict[str, int]

    def node_ids(self, names: Iterable[str]) -> list[int]:
        """Return the ids of nodes, each once."""
        return [self.nodes[name] for name in dict.fromkeys(names)]

    def topic_ids(self, names: Iterable[str]) -> list[int]:
        """Return the ids of topics, each once."""
        return [self.topics[name] for name in dict.fromkeys(names)]

    def matching_nodes(self, pattern: str) -> list[int]:
        """Return the nodes that a plan's publisher, a name or a pattern, means."""
        if pattern in self.nodes:
            return [self.nodes[pattern]]
        return [number for name, number in self.nodes.items() if matches_node(pattern, name)]


def page_ids(graph: InteractionGraph, report: RiskReport, plan: Plan | None) -> PageIds:
    """Return a number for every name that the graph, its risks or the plan speak of."""
    nodes = [node.name for node in graph.nodes]
    nodes += [endpoint.node for endpoint in graph.endpoints]
    nodes += [service.node for service in graph.services]
    nodes += [action.node for action in graph.actions]
    topics = [topic.name for topic in graph.topics]
    topics += [endpoint.topic for endpoint in graph.endpoints]
    for risk in report.risks:
        nodes += [*(n for role in risk.role_nodes.values() for n in role), *risk.successors]
        topics += risk.topics
    topics += _planned(plan) if plan else []
    return PageIds(_numbered(nodes), _numbered(topics))


def _planned(plan: Plan) -> list[str]:
    topics = [grcn.topic for grcn in plan.grcn]
    for monitor in plan.fps_monitor:
        topics += [monitor.topic, *([monitor.camera.topic] if monitor.camera else [])]
    if plan.rsrcn:
        topics += _coordinated(plan.rsrcn.vflows, plan.rsrcn.iflows)
    if plan.msrcn:
        topics += _coordinated(plan.msrcn.aflows, plan.msrcn.eflows)
    return topics


def _coordinated(
    guards: Sequence[GuardedTopic], watches: Sequence[WatchedFlow | EventFlow]
) -> list[str]:
    return [guard.topic for guard in guards] + [watch.topic for watch in watches]


def _numbered(names: Iterable[str]) -> dict[str, int]:
    return {name: number for number, name in enumerate(dict.fromkeys(names))}
