"""What a running system showed of its nodes, and a model's interface in the same words."""

import os
from pathlib import Path

import pytest
import yaml

_SIDES = {"pubs": "publish", "subs": "subscribe", "provides": "service"}
_KINDS = {"publishes": "publish", "subscribes": "subscribe"}
_ACTION_TOPICS = (
    ("publish", "feedback", "ActionFeedback"),
    ("publish", "result", "ActionResult"),
    ("publish", "status", ""),
    ("subscribe", "goal", "ActionGoal"),
    ("subscribe", "cancel", ""),
)


def truth(path):
    data = os.environ.get("RTRON_DATA")
    file = Path(data or "/nonexistent") / "groundtruth" / path
    if not file.is_file():
        pytest.skip("RTRON_DATA names no folder with groundtruth/")
    return yaml.safe_load(file.read_text(encoding="utf-8"))


def observed(system, node):
    nodes = {entry["fullname"]: entry for entry in truth(f"{system}/observed.architecture.yml")}
    found = nodes[node]
    return {
        (kind, entry["name"], entry["format"])
        for side, kind in _SIDES.items()
        for entry in found.get(side) or []
        if entry["name"] != "/clock" or side != "subs"
    }


def autorace(node):
    """Return (kind, name) of a node in the list made by hand, without what params switch off."""
    nodes = {entry["name"]: entry for entry in truth("autorace.yaml")["nodes"]}
    return {
        (_KINDS[kind], entry["topic"])
        for kind in _KINDS
        for entry in nodes[node].get(kind) or []
        if "default false" not in entry.get("when", "")
    }


def modelled(*interfaces, remaps=()):
    """Return (kind, name, type) after remapping, an action server as its topics."""
    targets = dict(remaps)
    return {
        (kind, targets.get(name, name), type)
        for found in interfaces
        for declaration in found.declarations
        for kind, name, type in _topics(declaration)
    }


def _topics(declaration):
    if declaration.kind == "action_server":
        action = declaration.type.removesuffix("Action")
        for kind, topic, suffix in _ACTION_TOPICS:
            plain = "actionlib_msgs/" + ("GoalStatusArray" if topic == "status" else "GoalID")
            yield kind, f"{declaration.name}/{topic}", action + suffix if suffix else plain
    elif declaration.kind in {"publish", "subscribe", "service"}:
        yield str(declaration.kind), declaration.name, declaration.type
