"""The coordination nodes of a plan as the page draws them over the graph (paper section 5.1)."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from rtron.reports.plan.descriptions import (
    describe_area,
    describe_event,
    describe_flow,
    describe_limit,
    describe_monitor,
    describe_rule,
    describe_transform,
)
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    CoordinationKind,
    EventFlow,
    Flow,
    FpsMonitor,
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


def plan_data(plan: Plan, names: PageIds) -> list[dict[str, Any]]:
    """Return each coordination node: what it guards (its flows) and what it only watches."""
    found = [_grcn(grcn, names) for grcn in plan.grcn]
    found += [_fps_monitor(monitor, names) for monitor in plan.fps_monitor]
    found += [_rsrcn(plan.rsrcn, names)] if plan.rsrcn else []
    found += [_msrcn(plan.msrcn, names)] if plan.msrcn else []
    return found


def _grcn(node: GRCN, names: PageIds) -> dict[str, Any]:
    guarded = GuardedTopic(
        topic=node.topic, type=node.type, flows=node.flows, successors=node.successors
    )
    return {
        "kind": CoordinationKind.GRCN.value,
        "domain": node.domain.value,
        "sharing": node.sharing.value,
        "unapproved": "block" if node.block_unapproved else "pass",
    } | _coordination(node, [guarded], (), names)


def _rsrcn(node: RSRCN, names: PageIds) -> dict[str, Any]:
    watches = [_watched(flow, names) for flow in node.iflows]
    return {
        "kind": CoordinationKind.RSRCN.value,
        "terms": list(describe_limit(node)),
    } | _coordination(node, node.vflows, watches, names)


def _msrcn(node: MSRCN, names: PageIds) -> dict[str, Any]:
    watches = [_watched(flow, names, describe_event(flow)) for flow in node.eflows]
    areas = [f"area {area.name}: {describe_area(area)}" for area in node.areas]
    return {
        "kind": CoordinationKind.MSRCN.value,
        "terms": [*areas, *map(describe_transform, node.transforms)],
        "rules": [[rule.name, describe_rule(rule), rule.reason] for rule in node.rules],
    } | _coordination(node, node.aflows, watches, names)


def _fps_monitor(node: FpsMonitor, names: PageIds) -> dict[str, Any]:
    frames = WatchedFlow(name=node.source.value, topic=node.topic, publisher=node.node)
    seen = [node.camera] if node.camera else []
    return {
        "kind": CoordinationKind.FPS_MONITOR.value,
        "id": node.id,
        "mode": "",
        "policy": "",
        "terms": [describe_monitor(node)],
        "guards": [],
        "watches": [_watched(flow, names) for flow in (frames, *seen)],
    }


def _coordination(
    node: GRCN | RSRCN | MSRCN,
    guards: Sequence[GuardedTopic],
    watches: Sequence[dict[str, Any]],
    names: PageIds,
) -> dict[str, Any]:
    return {
        "id": node.id,
        "mode": node.mode.value,
        "policy": node.policy.value,
        "guards": [_guarded(topic, names) for topic in guards],
        "watches": list(watches),
    }


def _guarded(guarded: GuardedTopic, names: PageIds) -> dict[str, Any]:
    return {
        "topic": names.topics[guarded.topic],
        "flows": [_flow(flow, names) for flow in guarded.flows],
        "successors": list(guarded.successors),
        "successorNodes": sorted(
            {n for each in guarded.successors for n in names.matching_nodes(each)}
        ),
    }


def _flow(flow: Flow, names: PageIds) -> dict[str, Any]:
    return {
        "name": flow.name,
        "publisher": flow.publisher,
        "nodes": names.matching_nodes(flow.publisher),
        "block": flow.block,
        "terms": describe_flow(flow),
    }


def _watched(flow: WatchedFlow | EventFlow, names: PageIds, note: str = "") -> dict[str, Any]:
    return {
        "name": flow.name,
        "topic": names.topics[flow.topic],
        "publisher": flow.publisher,
        "nodes": names.matching_nodes(flow.publisher),
        "note": note,
    }
