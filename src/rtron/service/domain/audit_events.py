"""What the audit log is told of changes; long texts are cut."""

import json
from collections.abc import Mapping
from typing import Any

from rtron.service.store.audit import AuditEvent
from rtron.wire.common.link_protocol import Applied

_MAX_LENGTH = 2000


def settings_answer_event(robot: str, applied: Applied) -> AuditEvent:
    """Return what a guard has said to settings."""
    detail = {"revision": applied.revision, "error": applied.error[:_MAX_LENGTH]}
    return AuditEvent(who=f"guard:{robot}", action="settings.answer", target=robot, detail=detail)


def truncated_json(nodes: Mapping[str, Any]) -> str:
    """Return the nodes of a change as JSON."""
    return json.dumps(nodes)[:_MAX_LENGTH]


def node_target(robot: str, node: str) -> str:
    """Return a coordination node as the target of a deed."""
    return f"{robot}/{node}"
