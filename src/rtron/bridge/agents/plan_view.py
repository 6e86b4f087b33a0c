"""What the files say to an agent: the graph, its risks, and what the plan limits and forbids."""

from collections.abc import Iterable, Iterator
from typing import Any

from rtron.reports.app.risks_json import risks_to_json
from rtron.vocabulary import (
    SECOND,
    Area,
    Flow,
    GuardedTopic,
    InteractionGraph,
    Plan,
    RiskReport,
    Stream,
    build_streams,
)

Document = dict[str, Any]
MAX_LISTED = 200
"""So many nodes or risks are listed at once; ask for one to see it."""


def show_plan(plan: Plan) -> Document:
    """Return who may publish what, and which nodes are behind."""
    return {
        "app": plan.app,
        "ros": plan.ros,
        "guarded": [_stream(each) for each in build_streams(plan)],
        "leases": [{"name": each.name, "ttl_s": each.ttl / SECOND} for each in plan.leases],
    }


def show_limits(plan: Plan) -> Document:
    """Return what the plan limits and forbids, whatever the state of the moment is."""
    document: Document = {}
    if plan.rsrcn:
        names = ("threshold", "max_vel_limit", "max_turn_limit", "max_side_limit", "lowest")
        values = {name: getattr(plan.rsrcn, name) for name in (*names, "max_accel_limit")}
        known = {name: value for name, value in values.items() if value is not None}
        topics = _topics(plan.rsrcn.vflows)
        policy = str(plan.rsrcn.policy)
        document["velocity"] = {"id": plan.rsrcn.id, "policy": policy, "topics": topics, **known}
    if plan.msrcn:
        document["mission"] = {
            "id": plan.msrcn.id,
            "topics": _topics(plan.msrcn.aflows),
            "rules": [
                {
                    "name": each.name,
                    "blocks": list(each.block),
                    "when": each.when,
                    "only_messages": each.action or "all",
                    "reason": each.reason,
                }
                for each in plan.msrcn.rules
            ],
            "areas": [_area(each) for each in plan.msrcn.areas],
        }
    return document


def show_graph(graph: InteractionGraph, about: str) -> Document:
    """Return the nodes of an app with their topics; `about` names one node or topic, or none."""
    endpoints = [each for each in graph.endpoints if about in ("", each.node, each.topic)]
    nodes: dict[str, dict[str, list[str]]] = {}
    for each in endpoints:
        sides = nodes.setdefault(each.node, {})
        sides.setdefault(str(each.direction), []).append(f"{each.topic} ({each.type})")
    listed = dict(list(nodes.items())[:MAX_LISTED])
    return {"app": graph.app, "nodes": listed, "left_out": len(nodes) - len(listed)}


def show_risks(report: RiskReport) -> Document:
    """Return the risks of an app, without the places in its code."""
    risks = risks_to_json(report)["risks"]
    shown = [{key: each[key] for key in each if key != "evidence"} for each in risks[:MAX_LISTED]]
    return {"risks": shown, "left_out": len(risks) - len(shown)}


def _stream(stream: Stream) -> Document:
    return {
        "topic": stream.topic,
        "type": stream.type,
        "mode": str(stream.mode),
        "policies": [f"{each.settings.policy} ({each.id})" for each in stream.stages],
        "flows": [_flow(each) for each in stream.flows],
        "behind": list(stream.successors),
    }


def _flow(flow: Flow) -> Document:
    return {"publisher": flow.publisher, "priority": flow.priority, "rank": str(flow.rank)}


def _topics(guarded: Iterable[GuardedTopic]) -> list[str]:
    return [each.topic for each in guarded]


def _area(area: Area) -> Document:
    corners: Iterator[list[float]] = ([each.x, each.y] for each in area.polygon)
    return {"name": area.name, "frame": area.frame, "polygon": list(corners)}
