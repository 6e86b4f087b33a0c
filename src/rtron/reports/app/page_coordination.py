"""The coordination nodes of a plan as the page draws them over the graph (paper section 5.1)."""

from collections.abc import Sequence
from typing import Any

from rtron.reports.app.page_ids import Numbers
from rtron.reports.plan.descriptions import (
    area_words,
    event_words,
    flow_words,
    limit_words,
    monitor_words,
    rule_words,
    transform_words,
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


def plan_data(plan: Plan, names: Numbers) -> list[dict[str, Any]]:
    """Return each coordination node: what it guards (its flows) and what it only watches."""
    found = [_grcn(grcn, names) for grcn in plan.grcn]
    found += [_fps_monitor(monitor, names) for monitor in plan.fps_monitor]
    found += [_rsrcn(plan.rsrcn, names)] if plan.rsrcn else []
    found += [_msrcn(plan.msrcn, names)] if plan.msrcn else []
    return found


def _grcn(node: GRCN, names: Numbers) -> dict[str, Any]:
    guarded = GuardedTopic(
        topic=node.topic, type=node.type, flows=node.flows, successors=node.successors
    )
    return {
        "kind": CoordinationKind.GRCN.value,
        "domain": node.domain.value,
        "sharing": node.sharing.value,
        "unapproved": "block" if node.block_unapproved else "pass",
    } | _coordination(node, [guarded], (), names)


def _rsrcn(node: RSRCN, names: Numbers) -> dict[str, Any]:
    watches = [_watched(flow, names) for flow in node.iflows]
    return {
        "kind": CoordinationKind.RSRCN.value,
        "terms": list(limit_words(node)),
    } | _coordination(node, node.vflows, watches, names)


def _msrcn(node: MSRCN, names: Numbers) -> dict[str, Any]:
    watches = [_watched(flow, names, event_words(flow)) for flow in node.eflows]
    areas = [f"area {area.name}: {area_words(area)}" for area in node.areas]
    return {
        "kind": CoordinationKind.MSRCN.value,
        "terms": [*areas, *map(transform_words, node.transforms)],
        "rules": [[rule.name, rule_words(rule), rule.reason] for rule in node.rules],
    } | _coordination(node, node.aflows, watches, names)


def _fps_monitor(node: FpsMonitor, names: Numbers) -> dict[str, Any]:
    frames = WatchedFlow(name=node.source.value, topic=node.topic, publisher=node.node)
    seen = [node.camera] if node.camera else []
    return {
        "kind": CoordinationKind.FPS_MONITOR.value,
        "id": node.id,
        "mode": "",
        "policy": "",
        "terms": [monitor_words(node)],
        "guards": [],
        "watches": [_watched(flow, names) for flow in (frames, *seen)],
    }


def _coordination(
    node: GRCN | RSRCN | MSRCN,
    guards: Sequence[GuardedTopic],
    watches: Sequence[dict[str, Any]],
    names: Numbers,
) -> dict[str, Any]:
    return {
        "id": node.id,
        "mode": node.mode.value,
        "policy": node.policy.value,
        "guards": [_guarded(topic, names) for topic in guards],
        "watches": list(watches),
    }


def _guarded(guarded: GuardedTopic, names: Numbers) -> dict[str, Any]:
    return {
        "topic": names.topics[guarded.topic],
        "flows": [_flow(flow, names) for flow in guarded.flows],
        "successors": list(guarded.successors),
        "successorNodes": sorted({n for each in guarded.successors for n in names.meant_by(each)}),
    }


def _flow(flow: Flow, names: Numbers) -> dict[str, Any]:
    return {
        "name": flow.name,
        "publisher": flow.publisher,
        "nodes": names.meant_by(flow.publisher),
        "block": flow.block,
        "terms": flow_words(flow),
    }


def _watched(flow: WatchedFlow | EventFlow, names: Numbers, note: str = "") -> dict[str, Any]:
    return {
        "name": flow.name,
        "topic": names.topics[flow.topic],
        "publisher": flow.publisher,
        "nodes": names.meant_by(flow.publisher),
        "note": note,
    }
