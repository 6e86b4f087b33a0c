"""Events of the audit log: who requests which change; long texts are cut."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rtron.wire.common.link_protocol import Applied

_MAX_LENGTH = 2000


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditEvent:
    """`actor` requests `action` on `target` from `address`; `detail` never holds a secret."""

    who: str
    action: str
    target: str
    address: str = ""
    detail: Mapping[str, Any] = field(default_factory=dict)


def settings_answer_event(robot: str, applied: Applied) -> AuditEvent:
    """Return the event of a guard's answer to settings."""
    detail = {"revision": applied.revision, "error": applied.error[:_MAX_LENGTH]}
    return AuditEvent(who=f"guard:{robot}", action="settings.answer", target=robot, detail=detail)


def truncated_json(nodes: Mapping[str, Any]) -> str:
    """Return the nodes of a change as JSON."""
    return json.dumps(nodes)[:_MAX_LENGTH]


def node_target(robot: str, node: str) -> str:
    """Return a coordination node as the target of an event."""
    return f"{robot}/{node}"
