"""What a plan file may leave out although the nouns have it: the one sensible value."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import count
from typing import Any, TypeVar

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
    action_of,
)

Numbered = TypeVar("Numbered", GRCN, FpsMonitor)


def derived(noun: type, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that make a noun: those of the file, and those that it left out."""
    made = {**_left_out(noun, values), **values}
    made.pop("schema", None)
    return made


def node_id(prefix: str, name: str) -> str:
    """Return the id of a coordination node from what it is for: `grcn_cmd_vel`."""
    return f"{prefix}_{re.sub(r'[^A-Za-z0-9]+', '_', name).strip('_')}"


def with_distinct_ids(nodes: Iterable[Numbered]) -> tuple[Numbered, ...]:
    """Return the coordination nodes, a number added where an id (of `/a/b` and `/a_b`) repeats."""
    made: dict[str, Numbered] = {}
    for node in nodes:
        free = (f"{node.id}_{number}" for number in count(2))
        id = node.id if node.id not in made else next(id for id in free if id not in made)
        made[id] = replace(node, id=id)
    return tuple(made.values())


def _left_out(noun: type, values: Mapping[str, Any]) -> dict[str, Any]:
    if noun is GRCN:
        return _grcn(values)
    if noun is FpsMonitor:
        return {"id": node_id("fps", values["node"])}
    return {
        Plan: {"app": ""},
        GuardedTopic: {"type": ""},
        RSRCN: {"id": "rsrcn"},
        MSRCN: {"id": "msrcn", "policy": PolicyName.BLOCK},
    }.get(noun, {})


def _grcn(values: Mapping[str, Any]) -> dict[str, Any]:
    goals = action_of(values["topic"], values.get("type") or "")
    acts = values["policy"] is PolicyName.FIFO_QUEUE or values.get("done") or goals
    return {
        "id": node_id("grcn", values["topic"]),
        "type": "",
        "domain": Domain.OTHERS,
        "kind": StreamKind.ACTION if acts else StreamKind.COMMAND,
        "sharing": Sharing.CONTEND,
    }
