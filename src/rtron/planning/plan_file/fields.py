"""How the nouns of a plan are written in its file: keys, what each holds, what may be left out.

The reader, the writer and the JSON Schema all follow this form, so that they agree.
"""

import re
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields
from types import UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from rtron.planning.plan_file.durations import LONGEST
from rtron.planning.plan_file.quantities import (
    ANGULAR_DECELERATION,
    DECELERATION,
    PER_FRAME,
    POSITION,
    VELOCITY,
    YAW,
    Quantity,
)
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    PLAN_SCHEMA,
    RSRCN,
    SECOND,
    Area,
    Audit,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    MessageDefinition,
    Plan,
    Point,
    Rule,
    Stop,
    Transform,
    WatchedFlow,
    Word,
)

T = TypeVar("T")
_NAME = "[A-Za-z0-9_]+"
_WORD = "[A-Za-z][A-Za-z0-9_]*"
_FRAME = "/?[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*"
_TYPE = rf"{_WORD}/((msg|action)/)?{_WORD}"
# The keywords and reserved words of CEL, the language of the expressions.
_CEL_WORDS = (
    "true|false|null|in|as|break|const|continue|else|for|function|if|import|let|loop|package"
    "|namespace|return|var|void|while"
)


@dataclass(frozen=True, slots=True)
class Text:
    """What a text must look like, as an expression and in words."""

    pattern: str
    words: str
    longest: int = 255

    def fits(self, text: str) -> bool:
        """Tell whether a text looks like that."""
        return len(text) <= self.longest and re.fullmatch(self.pattern, text) is not None


TOPIC = Text(rf"(/{_NAME})+", "a full topic name like /cmd_vel")
NODE = Text(r"(/[A-Za-z0-9_*]+)+", "a full node name like /move_base, `*` for what changes")
TYPE = Text(rf"({_TYPE})?", "a message type like pkg/Name")
WORD = Text(_WORD, "a word of letters, digits and _")
ANY = Text(r"[\s\S]*", "a text of at most 1000 characters", longest=1000)
_VARIABLE = Text(
    rf"(?!({_CEL_WORDS})$){_WORD}", "a word of letters, digits and _ that expressions leave free"
)
_FLOW = Text(rf"((/{_NAME})+|{_WORD})", "a full topic name like /cmd_vel or the name of a flow")
_EXPRESSION = Text(r"(\s*\S[\s\S]*)?", "an expression of at most 4096 characters", longest=4096)

# What a text under a key looks like, and under one noun's key where it differs.
_TEXTS = {
    "topic": TOPIC,
    "done": TOPIC,
    "publisher": NODE,
    "node": NODE,
    "successors": NODE,
    "type": TYPE,
    "MessageDefinition.type": Text(_TYPE, TYPE.words),
    "name": WORD,
    "EventFlow.name": _VARIABLE,
    "Area.name": _VARIABLE,
    "id": WORD,
    "when": _EXPRESSION,
    "action": _EXPRESSION,
    "definition": Text(r"[\s\S]*", "a text of at most 65536 characters", longest=65536),
    "frame": Text(rf"({_FRAME})?", "a frame like map"),
    "Area.frame": Text(_FRAME, "a frame like map"),
    "source": Text(_FRAME, "a frame like odom"),
    "target": Text(_FRAME, "a frame like map"),
    "block": _FLOW,
    "require": Text(rf"{_FLOW.pattern}?", _FLOW.words),
}
_LASTS = (0, LONGEST)
_LASTS_A_WHILE = (1, LONGEST)
_DURATIONS = {
    "timeout": _LASTS,
    "release_after": _LASTS,
    "max_age": _LASTS,
    "EventFlow.max_age": _LASTS_A_WHILE,
    "max_hold": _LASTS,
    "silent_after": _LASTS_A_WHILE,
    "present": _LASTS_A_WHILE,
    "silent": _LASTS_A_WHILE,
    "window": (SECOND // 10, 60 * SECOND),
    "period": (SECOND // 1000, SECOND),
    "Audit.period": (SECOND // 100, SECOND // 10),
    "repeat": _LASTS,
}
_RANGES = {
    "ros": (1, 2),
    "revision": (0, 2**63 - 1),
    "priority": (-(2**31), 2**31 - 1),
    "queue_size": (1, 1_000_000),
}
_QUANTITIES = {
    "threshold": PER_FRAME,
    "max_vel_limit": VELOCITY,
    "lowest": VELOCITY,
    "decel": DECELERATION,
    "angular_decel": ANGULAR_DECELERATION,
    "x": POSITION,
    "y": POSITION,
    "yaw": YAW,
}
_DERIVED: Mapping[type, frozenset[str]] = {
    Plan: frozenset({"app"}),
    GRCN: frozenset({"id", "type", "domain", "kind", "sharing"}),
    GuardedTopic: frozenset({"type"}),
    FpsMonitor: frozenset({"id"}),
    RSRCN: frozenset({"id"}),
    MSRCN: frozenset({"id", "policy"}),
}
NOUNS: Mapping[type, str] = {
    Plan: "the plan",
    GRCN: "a GRCN",
    RSRCN: "the RSRCN",
    MSRCN: "the MSRCN",
    GuardedTopic: "a guarded topic",
    Flow: "a flow",
    WatchedFlow: "a watched flow",
    EventFlow: "an eflow",
    Rule: "a rule",
    Area: "an area",
    Point: "a point",
    Transform: "a transform",
    FpsMonitor: "an fps_monitor",
    Stop: "the stop",
    Audit: "the audit",
    MessageDefinition: "a message definition",
}


class Schema(Word):
    """What a plan file says that it is."""

    PLAN = PLAN_SCHEMA


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """A key of a noun and what it holds: `item` itself, or a list of such if `many`.

    `text` is what a text must look like, `range` the least and greatest number or duration (ns).
    """

    name: str
    item: Any
    many: bool
    optional: bool
    required: bool
    default: Any
    text: Text = ANY
    range: tuple[int, int] = (0, 0)
    duration: bool = False
    quantity: Quantity | None = None


def keys(noun: type) -> Mapping[str, Key]:
    """Return the keys of a noun, in the order in which they are written."""
    return _KEYS[noun]


def _keys(noun: type) -> Mapping[str, Key]:
    hints = get_type_hints(noun)
    own = {field.name: _key(noun, field, hints[field.name]) for field in fields(noun)}
    return {_SCHEMA.name: _SCHEMA, **own} if noun is Plan else own


def _key(noun: type, field: Field[Any], hint: Any) -> Key:  # noqa: ANN401 - a type hint
    many = get_origin(hint) is tuple
    optional = isinstance(hint, UnionType)
    needed = field.default is MISSING and field.default_factory is MISSING
    item = get_args(hint)[0] if many or optional else hint
    own = f"{noun.__name__}.{field.name}"
    lasts = _own(_DURATIONS, own) if item is int else None
    return Key(
        name=field.name,
        item=item,
        many=many,
        optional=optional,
        required=needed and field.name not in _DERIVED.get(noun, ()),
        default=field.default,
        text=_own(_TEXTS, own) or ANY,
        range=lasts or _RANGES.get(field.name, (0, 0)),
        duration=lasts is not None,
        quantity=_QUANTITIES[field.name] if item is float else None,
    )


def _own(table: Mapping[str, T], name: str) -> T | None:
    """Return what a table says of one noun's key, or else of the key under every noun."""
    return table.get(name) or table.get(name.partition(".")[2])


_SCHEMA = Key(
    name="schema", item=Schema, many=False, optional=False, required=False, default=MISSING
)
_KEYS = {noun: _keys(noun) for noun in NOUNS}
