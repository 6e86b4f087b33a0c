"""The last violation in the paper's terms (section 6.3): violated rule, cause and details."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rtron.planning.coherence.rsrcn import BY_LIMIT, BY_RATE
from rtron.service.domain.risk_model import Coordination
from rtron.vocabulary import GRCN, MSRCN, RSRCN, UNAPPROVED, PolicyName

_TURNS: Mapping[PolicyName, str] = {
    PolicyName.BLOCK: "no flow passes whose block bit is 1",
    PolicyName.FIFO_QUEUE: "one at a time, in the order of arrival",
    PolicyName.PRIORITY_QUEUE: "one at a time, the highest priority first",
    PolicyName.PREEMPTION: "the highest priority that speaks controls it",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Violation:
    """What a coordination node enforces, who went against it, and what the guard did."""

    rule: str = ""
    cause: str = ""
    details: str = ""


def violation(node: Coordination, event: Mapping[str, Any]) -> Violation:
    """Return in words an event, as the API shows it, that violates what `node` enforces."""
    return Violation(rule=_rule(node, event), cause=_cause(event), details=_details(event))


def _rule(node: Coordination, event: Mapping[str, Any]) -> str:
    if event["flow"] == UNAPPROVED:
        return f"only the publishers that the plan names may speak on {event['topic']}"
    if isinstance(node, RSRCN):
        return f"{node.policy}: {_limit(node)}"
    if isinstance(node, MSRCN):
        return _mission(node, event["reason"])
    if isinstance(node, GRCN):
        return f"{node.policy} on {node.topic}: {_TURNS[node.policy]}"
    return ""


def _limit(node: RSRCN) -> str:
    limits = []
    if node.policy in BY_RATE and node.threshold is not None:
        limits.append(f"at most {node.threshold:g} m a frame")
    if node.policy in BY_LIMIT and node.max_vel_limit is not None:
        limits.append(f"at most {node.max_vel_limit:g} m/s")
    return " and ".join(limits) or _TURNS[PolicyName.BLOCK]


def _mission(node: MSRCN, reason: str) -> str:
    """Name the rule that the guard's reason speaks of, or else all that could be meant."""
    words = set(reason.replace(":", " ").replace(",", " ").split())
    for rule in node.rules:
        if rule.name in words:
            return f"{rule.name}: {rule.reason or rule.when}"
    return f"{node.policy}: {_TURNS[PolicyName.BLOCK]}"


def _cause(event: Mapping[str, Any]) -> str:
    who = event["publisher"] or event["flow"]
    where = f" on {event['topic']}" if event["topic"] else ""
    return f"{who}{where}" if who else f"{event['kind']}{where}"


def _details(event: Mapping[str, Any]) -> str:
    what = event["decision"] or event["kind"]
    said = f": {event['reason']}" if event["reason"] else ""
    return f"{what}{said} (settings {event['revision']})"
