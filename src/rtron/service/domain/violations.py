"""The last violation in the paper's terms (section 6.3): violated rule, cause and details."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rtron.coherence.rsrcn import FRAME_RATE_POLICIES, VELOCITY_LIMIT_POLICIES
from rtron.service.domain.risk_model import CoordinationNode
from rtron.vocabulary import GRCN, MSRCN, RSRCN, UNAPPROVED, PolicyName

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
