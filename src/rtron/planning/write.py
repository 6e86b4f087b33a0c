"""A plan as YAML that a person likes to read and edit; reading it gives the same plan."""

import re
from collections.abc import Iterator
from dataclasses import MISSING
from enum import Enum
from typing import Any

import yaml

from rtron.planning.durations import write_duration
from rtron.planning.form import NOUNS, Key, keys
from rtron.vocabulary import PLAN_SCHEMA, Flow, Plan, WatchedFlow

_HEAD = """\
# What stands between the nodes of this app, and under which policies. Edit it freely, then run
# `rtron check`. Durations take a unit: 200 ms, 0.5 s, 2 min. What is left out has its default.
"""
_SECTIONS = {
    "grcn": """
# GRCN: one for each topic that several nodes share. `enforce` stands in the flow and decides,
# `observe` only watches. Preemption: the highest priority that speaks has the output.
# Priority_Queue and FIFO_Queue: one at a time, the others wait. Block: each flow has a bit.
""",
    "rsrcn": """
# RSRCN: the one before everybody who obeys a velocity. It knows the rates of the image nodes
# (iflows) and decides about the velocities (vflows).
""",
    "msrcn": """
# MSRCN: the one before the actuators. It knows the events (eflows) and blocks the actions
# (aflows) that the rules of the mission forbid.
""",
    "fps_monitor": """
# fps_monitor: one for each image node, on the topic that it publishes for every frame.
""",
    "accept_unenforceable": """
# What cannot be guarded and was accepted.
""",
}
_ON_ONE_LINE = (Flow, WatchedFlow)
_SAFE = re.compile(r"[A-Za-z/][A-Za-z0-9_/.-]*")


def write_plan(plan: Plan) -> str:
    """Return the plan as YAML with a comment for each section; what has its default is left out."""
    head = [_HEAD.rstrip("\n"), f"schema: {PLAN_SCHEMA}", f"app: {_scalar(plan.app)}"]
    return "\n".join([*head, *_sections(plan)]) + "\n"


def _sections(plan: Plan) -> Iterator[str]:
    for key in _written(plan):
        if key.name in _SECTIONS:
            yield _SECTIONS[key.name].rstrip("\n")
        if key.name != "app":
            yield from _entry(key, getattr(plan, key.name), 0)


def _written(noun: object) -> Iterator[Key]:
    """Yield the keys of a noun that differ from their defaults."""
    for key in keys(type(noun)).values():
        if key.name != "schema" and (
            key.default is MISSING or getattr(noun, key.name) != key.default
        ):
            yield key


def _entry(key: Key, value: Any, indent: int) -> Iterator[str]:  # noqa: ANN401 - as the key says
    space = " " * indent
    if not value and key.many:
        yield f"{space}{key.name}: []"
    elif key.many and key.item in NOUNS:
        yield f"{space}{key.name}:"
        for noun in value:
            yield from _item(noun, indent + 2)
    elif key.item in NOUNS:
        yield f"{space}{key.name}:"
        yield from _noun(value, indent + 2)
    else:
        yield f"{space}{key.name}: {_value(key, value)}"


def _item(noun: object, indent: int) -> Iterator[str]:
    space = " " * indent
    if isinstance(noun, _ON_ONE_LINE):
        pairs = (f"{key.name}: {_value(key, getattr(noun, key.name))}" for key in _written(noun))
        yield f"{space}- {{{', '.join(pairs)}}}"
        return
    first, *others = _noun(noun, indent + 2)
    yield f"{space}- {first.lstrip()}"
    yield from others


def _noun(noun: object, indent: int) -> Iterator[str]:
    for key in _written(noun):
        yield from _entry(key, getattr(noun, key.name), indent)


def _value(key: Key, value: Any) -> str:  # noqa: ANN401 - as the key says
    if key.many:
        return f"[{', '.join(map(_scalar, value))}]"
    if key.duration and value is not None:
        return write_duration(value)
    return _scalar(value)


def _scalar(value: object) -> str:
    text = str(value.value) if isinstance(value, Enum) else value
    if isinstance(text, bool):
        return "true" if text else "false"
    if text is None:
        return "null"
    if isinstance(text, int) or (_SAFE.fullmatch(str(text)) and _stays_text(str(text))):
        return str(text)
    return str(
        yaml.safe_dump(text, default_style='"', width=float("inf"), allow_unicode=True)
    ).strip()


def _stays_text(text: str) -> bool:
    return isinstance(yaml.safe_load(text), str)
