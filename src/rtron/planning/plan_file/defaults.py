"""What a plan file may leave out although the nouns have it: the one sensible value."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import count
from typing import Any, TypeVar

from rtron.planning.plan_file.fields import APP_NAME, UNSAFE_CHARACTERS
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    Domain,
    FpsMonitor,
    GuardedTopic,
    Plan,
    PolicyName,
    Sharing,
    StreamKind,
    action_name,
)

NodeWithId = TypeVar("NodeWithId", GRCN, FpsMonitor)


def with_defaults(plan_type: type, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that make a noun: those of the file, and those that it left out."""
    complete = {**_default_values(plan_type, values), **values}
    complete.pop("schema", None)
    return complete


def node_id(prefix: str, name: str) -> str:
    """Return the id of a coordination node from what it is for: `grcn_cmd_vel`."""
    return f"{prefix}_{re.sub(r'[^A-Za-z0-9]+', '_', name).strip('_')}"


def app_name(title: str) -> str:
    """Return the name of an app in its plan: what it is called, without what a plan refuses."""
    parts = (re.sub(rf"[{UNSAFE_CHARACTERS}]+", " ", part).strip() for part in title.split("/"))
    name = "/".join(part for part in parts if part.strip("."))[: APP_NAME.max_length]
    while name and not APP_NAME.matches(name):
        name = name[:-1]
    return name


def with_distinct_ids(nodes: Iterable[NodeWithId]) -> tuple[NodeWithId, ...]:
    """Return the coordination nodes, a number added where an id (of `/a/b` and `/a_b`) repeats."""
    by_id: dict[str, NodeWithId] = {}
    for node in nodes:
        free = (f"{node.id}_{number}" for number in count(2))
        id = node.id if node.id not in by_id else next(id for id in free if id not in by_id)
        by_id[id] = replace(node, id=id)
    return tuple(by_id.values())


def _default_values(plan_type: type, values: Mapping[str, Any]) -> dict[str, Any]:
    if plan_type is GRCN:
        return _grcn(values)
    if plan_type is FpsMonitor:
        return {"id": node_id("fps", values["node"])}
    return {
        Plan: {"app": ""},
        GuardedTopic: {"type": ""},
        RSRCN: {"id": "rsrcn"},
        MSRCN: {"id": "msrcn", "policy": PolicyName.BLOCK},
    }.get(plan_type, {})


def _grcn(values: Mapping[str, Any]) -> dict[str, Any]:
    action = action_name(values["topic"], values.get("type") or "")
    is_action = values["policy"] is PolicyName.FIFO_QUEUE or values.get("done") or action
    return {
        "id": node_id("grcn", values["topic"]),
        "type": "",
        "domain": Domain.OTHERS,
        "kind": StreamKind.ACTION if is_action else StreamKind.COMMAND,
        "sharing": Sharing.CONTEND,
    }
