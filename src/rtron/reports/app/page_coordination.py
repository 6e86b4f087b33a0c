"""The coordination nodes of a plan as the page draws them over the graph (paper section 5.1)."""

from collections.abc import Sequence
from typing import Any

from rtron.reports.app.page_ids import PageIds
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
    Plan,
    WatchedFlow,
)


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
