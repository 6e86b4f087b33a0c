"""Events of the audit log: who requests which change; long texts are cut."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from rtron.wire.common.link_protocol import Applied

_MAX_LENGTH = 2000
_ROBOT_ACTIONS = frozenset(
    {
        "acknowledge",
        "dry_run",
        "graph",
        "labels",
        "lease.answer",
        "lease.end",
        "lease.give",
        "lease.renew",
        "override",
        "override.end",
        "plan",
        "request.answer",
        "request.approve",
        "request.refuse",
        "settings",
        "settings.answer",
        "settings.restore",
        "settings.take_back",
        "stop",
        "stop.end",
    }
)
"""What is done to a robot, or by its guard: the target begins with the robot's name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditEvent:
    """`actor` requests `action` on `target` from `address`; `detail` never holds a secret."""

    who: str
    action: str
    target: str
    address: str = ""
    detail: Mapping[str, Any] = field(default_factory=dict)

    @property
    def robot(self) -> str:
        """The robot that it is about, "" for what is about the service."""
        return self.target.partition("/")[0] if self.action in _ROBOT_ACTIONS else ""


def settings_answer_event(robot: str, applied: Applied) -> AuditEvent:
    """Return the event of a guard's answer to settings."""
    detail = {"revision": applied.revision, "error": applied.error[:_MAX_LENGTH]}
    return AuditEvent(who=f"guard:{robot}", action="settings.answer", target=robot, detail=detail)


def lease_answer_event(robot: str, target: str, action: str) -> AuditEvent:
    """Return the event of a guard's answer to what a person has asked of a lease."""
    detail = {"do": action}
    return AuditEvent(who=f"guard:{robot}", action="lease.answer", target=target, detail=detail)


def request_answer_event(robot: str, target: str, action: str) -> AuditEvent:
    """Return the event of a bridge's answer to what a person has said to a request."""
    detail = {"do": action}
    return AuditEvent(who=f"guard:{robot}", action="request.answer", target=target, detail=detail)


def truncated_json(nodes: Mapping[str, Any] | Sequence[str]) -> str:
    """Return what is changed as JSON."""
    return json.dumps(nodes)[:_MAX_LENGTH]


def node_target(robot: str, node: str) -> str:
    """Return a coordination node as the target of an event."""
    return f"{robot}/{node}"
