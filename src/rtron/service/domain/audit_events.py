"""What the audit log is told of changes; long texts are cut."""

import json
from collections.abc import Mapping
from typing import Any

from rtron.service.store.audit import Deed
from rtron.wire.common.link_protocol import Applied

_LONGEST = 2000


def answer_deed(robot: str, applied: Applied) -> Deed:
    """Return what a guard has said to settings."""
    detail = {"revision": applied.revision, "error": applied.error[:_LONGEST]}
    return Deed(who=f"guard:{robot}", action="settings.answer", target=robot, detail=detail)


def short_nodes(nodes: Mapping[str, Any]) -> str:
    """Return the nodes of a change as JSON."""
    return json.dumps(nodes)[:_LONGEST]


def place(robot: str, node: str) -> str:
    """Return a coordination node as the target of a deed."""
    return f"{robot}/{node}"
