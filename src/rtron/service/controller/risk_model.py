"""The risk model of each coordination node (paper section 6.3, figure): metadata and settings."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, TypeAlias

from rtron.reports.text_layout import counted
from rtron.service.store.robots import RiskModel, plan_json
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    CoordinationKind,
    FpsMonitor,
    GuardedTopic,
    Plan,
    RiskKind,
    WatchedFlow,
)

_MOST_RISKS = 20
_LONGEST = 1000
_LISTED = 3
_KINDS: Mapping[CoordinationKind, tuple[RiskKind, ...]] = {
    CoordinationKind.GRCN: (RiskKind.GR_ST, RiskKind.GR_MT),
    CoordinationKind.RSRCN: (RiskKind.RSR,),
    CoordinationKind.MSRCN: (RiskKind.MSR,),
    CoordinationKind.FPS_MONITOR: (RiskKind.RSR,),
}
_ABOUT = ("id", "kind", "severity", "reason", "role_nodes", "topics", "successors")
Coordination: TypeAlias = GRCN | RSRCN | MSRCN | FpsMonitor
"""A coordination node of a plan."""


def risk_models(plan: Plan, in_force: Plan, risks: Sequence[Mapping[str, Any]]) -> list[RiskModel]:
    """Return the risk models of a plan, and what is `in_force`; risks are as in `rtron.risks/1`."""
    settings = node_json(in_force)
    return [
        RiskModel(
            node=node.id,
            type=kind.value,
            description=_description(node)[:_LONGEST],
            risk_information=_information(kind, topics(node), risks),
            policy_settings=settings[node.id],
        )
        for kind, node in coordination(plan)
    ]


def coordination(plan: Plan) -> Iterator[tuple[CoordinationKind, Coordination]]:
    """Yield the coordination nodes of a plan, each with its kind, in the plan's order."""
    yield from ((CoordinationKind.GRCN, grcn) for grcn in plan.grcn)
    if plan.rsrcn:
        yield CoordinationKind.RSRCN, plan.rsrcn
    if plan.msrcn:
        yield CoordinationKind.MSRCN, plan.msrcn
    yield from ((CoordinationKind.FPS_MONITOR, monitor) for monitor in plan.fps_monitor)


def node_json(plan: Plan) -> dict[str, dict[str, Any]]:
    """Return the coordination nodes of a plan as JSON, by id."""
    document = plan_json(plan)
    single = [document[key] for key in ("rsrcn", "msrcn") if document[key]]
    nodes = [*document["grcn"], *single, *document["fps_monitor"]]
    return {node["id"]: node for node in nodes}


def topics(node: Coordination) -> list[str]:
    """Return the topics that a coordination node guards or watches, guarded ones first."""
    if isinstance(node, (GRCN, FpsMonitor)):
        return [node.topic]
    guarded, watched = _sides(node)
    return list(dict.fromkeys(each.topic for each in (*guarded, *watched)))


def _sides(node: RSRCN | MSRCN) -> tuple[Sequence[GuardedTopic], Sequence[Any]]:
    return (node.vflows, node.iflows) if isinstance(node, RSRCN) else (node.aflows, node.eflows)


def _description(node: Coordination) -> str:
    if isinstance(node, GRCN):
        who = _listed([flow.publisher for flow in node.flows])
        return f"Decides which of {who} controls {node.topic}, before {_listed(node.successors)}."
    if isinstance(node, FpsMonitor):
        return f"Measures the frame rate of {node.node} on {node.topic}."
    guarded, watched = _sides(node)
    acting = _listed([each.topic for each in guarded])
    if isinstance(node, RSRCN):
        return f"Limits the velocity on {acting} to what {_seers(watched)} can follow."
    rules, events = counted(len(node.rules), "rule"), counted(len(watched), "event")
    return f"Blocks actions on {acting} that {rules} of the mission forbid; it knows {events}."


def _seers(iflows: Sequence[WatchedFlow]) -> str:
    return _listed([flow.publisher for flow in iflows]) if iflows else "the image nodes"


def _listed(names: Sequence[str]) -> str:
    if not names:
        return "nobody"
    more = len(names) - _LISTED
    return ", ".join(names[:_LISTED]) + (f" and {more} more" if more > 0 else "")


def _information(
    kind: CoordinationKind, topics: Collection[str], risks: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    kinds = {each.value for each in _KINDS[kind]}
    found = [
        {key: risk[key] for key in _ABOUT}
        for risk in risks
        if risk["kind"] in kinds and not set(topics).isdisjoint(risk["topics"])
    ]
    return {"risks": found[:_MOST_RISKS], "number": len(found)}
