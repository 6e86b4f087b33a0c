"""The risk model of each coordination node (paper section 6.3, figure): metadata and settings."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from rtron.coherence.rsrcn import FRAME_RATE_POLICIES, VELOCITY_LIMIT_POLICIES
from rtron.reports.text_layout import counted
from rtron.service.domain.plan_json import plan_json
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    UNAPPROVED,
    CoordinationKind,
    FpsMonitor,
    GuardedTopic,
    Plan,
    PolicyName,
    RiskKind,
    WatchedFlow,
)

_MAX_RISKS = 20
_MAX_DESCRIPTION = 1000
_MAX_NAMES = 3
_RISK_KINDS: Mapping[CoordinationKind, tuple[RiskKind, ...]] = {
    CoordinationKind.GRCN: (RiskKind.GR_ST, RiskKind.GR_MT),
    CoordinationKind.RSRCN: (RiskKind.RSR,),
    CoordinationKind.MSRCN: (RiskKind.MSR,),
    CoordinationKind.FPS_MONITOR: (RiskKind.RSR,),
}
_RISK_KEYS = ("id", "kind", "severity", "reason", "role_nodes", "topics", "successors")
CoordinationNode: TypeAlias = GRCN | RSRCN | MSRCN | FpsMonitor
"""A coordination node of a plan."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RiskModel:
    """What is kept of one coordination node: metadata, and its policy settings as JSON."""

    node: str
    type: str
    description: str
    risk_information: dict[str, Any]
    policy_settings: dict[str, Any]


def build_risk_models(
    plan: Plan, in_force: Plan, risks: Sequence[Mapping[str, Any]]
) -> list[RiskModel]:
    """Return the risk models of a plan, and what is `in_force`; risks are as in `rtron.risks/2`."""
    settings = node_json(in_force)
    return [
        RiskModel(
            node=node.id,
            type=kind.value,
            description=_description(node)[:_MAX_DESCRIPTION],
            risk_information=_risk_information(kind, topics(node), risks),
            policy_settings=settings[node.id],
        )
        for kind, node in planned_nodes(plan)
    ]


def planned_nodes(plan: Plan) -> Iterator[tuple[CoordinationKind, CoordinationNode]]:
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


def topics(node: CoordinationNode) -> list[str]:
    """Return the topics that a coordination node guards or watches, guarded ones first."""
    if isinstance(node, (GRCN, FpsMonitor)):
        return [node.topic]
    guarded, watched = _guarded_and_watched(node)
    return list(dict.fromkeys(each.topic for each in (*guarded, *watched)))


def _guarded_and_watched(node: RSRCN | MSRCN) -> tuple[Sequence[GuardedTopic], Sequence[Any]]:
    return (node.vflows, node.iflows) if isinstance(node, RSRCN) else (node.aflows, node.eflows)


def _description(node: CoordinationNode) -> str:
    if isinstance(node, GRCN):
        who = _name_list([flow.publisher for flow in node.flows])
        return (
            f"Decides which of {who} controls {node.topic}, before {_name_list(node.successors)}."
        )
    if isinstance(node, FpsMonitor):
        return f"Measures the frame rate of {node.node} on {node.topic}."
    guarded, watched = _guarded_and_watched(node)
    acting = _name_list([each.topic for each in guarded])
    if isinstance(node, RSRCN):
        return f"Limits the velocity on {acting} to what {_image_nodes(watched)} can follow."
    rules, events = counted(len(node.rules), "rule"), counted(len(watched), "event")
    return f"Blocks actions on {acting} that {rules} of the mission forbid; it knows {events}."


def _image_nodes(iflows: Sequence[WatchedFlow]) -> str:
    return _name_list([flow.publisher for flow in iflows]) if iflows else "the image nodes"


def _name_list(names: Sequence[str]) -> str:
    if not names:
        return "nobody"
    more = len(names) - _MAX_NAMES
    return ", ".join(names[:_MAX_NAMES]) + (f" and {more} more" if more > 0 else "")


def _risk_information(
    kind: CoordinationKind, topics: Collection[str], risks: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    kinds = {each.value for each in _RISK_KINDS[kind]}
    matching = [
        {key: risk[key] for key in _RISK_KEYS}
        for risk in risks
        if risk["kind"] in kinds and not set(topics).isdisjoint(risk["topics"])
    ]
    return {"risks": matching[:_MAX_RISKS], "number": len(matching)}


_POLICY_RULES: Mapping[PolicyName, str] = {
    PolicyName.BLOCK: "no flow passes whose block bit is 1",
    PolicyName.FIFO_QUEUE: "one at a time, in the order of arrival",
    PolicyName.PRIORITY_QUEUE: "one at a time, the highest priority first",
    PolicyName.PREEMPTION: "the highest priority that speaks controls it",
    PolicyName.LEASE: "only the holder of the lease controls it, once it has been neutral",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Violation:
    """What a coordination node enforces, who went against it, and what the guard did."""

    rule: str = ""
    cause: str = ""
    details: str = ""


def describe_violation(node: CoordinationNode, event: Mapping[str, Any]) -> Violation:
    """Return in words an event, as the API shows it, that violates what `node` enforces."""
    return Violation(rule=_violated_rule(node, event), cause=_cause(event), details=_details(event))


def _violated_rule(node: CoordinationNode, event: Mapping[str, Any]) -> str:
    if event["flow"] == UNAPPROVED:
        return f"only the publishers that the plan names may speak on {event['topic']}"
    if isinstance(node, RSRCN):
        return f"{node.policy}: {_speed_limits(node)}"
    if isinstance(node, MSRCN):
        return _mission_rule(node, event["reason"])
    if isinstance(node, GRCN):
        return f"{node.policy} on {node.topic}: {_POLICY_RULES[node.policy]}"
    return ""


def _speed_limits(node: RSRCN) -> str:
    limits = []
    if node.policy in FRAME_RATE_POLICIES and node.threshold is not None:
        limits.append(f"at most {node.threshold:g} m a frame")
    if node.policy in VELOCITY_LIMIT_POLICIES and node.max_vel_limit is not None:
        limits.append(f"at most {node.max_vel_limit:g} m/s")
    return " and ".join(limits) or _POLICY_RULES[PolicyName.BLOCK]


def _mission_rule(node: MSRCN, reason: str) -> str:
    """Name the rule that the guard's reason speaks of, or else all that could be meant."""
    reason_words = set(reason.replace(":", " ").replace(",", " ").split())
    for rule in node.rules:
        if rule.name in reason_words:
            return f"{rule.name}: {rule.reason or rule.when}"
    return f"{node.policy}: {_POLICY_RULES[PolicyName.BLOCK]}"


def _cause(event: Mapping[str, Any]) -> str:
    who = event["publisher"] or event["flow"]
    where = f" on {event['topic']}" if event["topic"] else ""
    return f"{who}{where}" if who else f"{event['kind']}{where}"


def _details(event: Mapping[str, Any]) -> str:
    what = event["decision"] or event["kind"]
    reason = f": {event['reason']}" if event["reason"] else ""
    return f"{what}{reason} (settings {event['revision']})"
