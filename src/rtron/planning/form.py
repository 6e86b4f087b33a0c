"""How the nouns of a plan are written in its file: keys, what each holds, what may be left out.

The reader, the writer and the JSON Schema all follow this form, so that they agree.
"""

import re
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields
from types import UnionType
from typing import Any, get_args, get_origin, get_type_hints

from rtron.vocabulary import (
    GRCN,
    MSRCN,
    PLAN_SCHEMA,
    RSRCN,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Plan,
    WatchedFlow,
    Word,
)

_NAME = "[A-Za-z0-9_]+"
_WORD = "[A-Za-z][A-Za-z0-9_]*"


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
TYPE = Text(rf"({_WORD}/((msg|action)/)?{_WORD})?", "a message type like pkg/Name")
WORD = Text(_WORD, "a word of letters, digits and _")
ANY = Text(r"[\s\S]*", "a text of at most 1000 characters", longest=1000)

_TEXTS = {
    "topic": TOPIC,
    "done": TOPIC,
    "publisher": NODE,
    "node": NODE,
    "successors": NODE,
    "type": TYPE,
    "name": WORD,
    "id": WORD,
}
_DURATIONS = frozenset({"timeout", "release_after", "max_age", "max_hold"})
_RANGES = {
    "ros": (1, 2),
    "revision": (0, 2**63 - 1),
    "priority": (-(2**31), 2**31 - 1),
    "queue_size": (1, 1_000_000),
}
_DERIVED: Mapping[type, frozenset[str]] = {
    Plan: frozenset({"app"}),
    GRCN: frozenset({"id", "type", "domain", "kind", "sharing"}),
    GuardedTopic: frozenset({"type"}),
    FpsMonitor: frozenset({"id"}),
    RSRCN: frozenset({"id"}),
    MSRCN: frozenset({"id"}),
}
NOUNS: Mapping[type, str] = {
    Plan: "the plan",
    GRCN: "a GRCN",
    RSRCN: "the RSRCN",
    MSRCN: "the MSRCN",
    GuardedTopic: "a guarded topic",
    Flow: "a flow",
    WatchedFlow: "a watched flow",
    FpsMonitor: "an fps_monitor",
}


class Schema(Word):
    """What a plan file says that it is."""

    PLAN = PLAN_SCHEMA


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """A key of a noun and what it holds: `item` itself, or a list of such if `many`."""

    name: str
    item: Any
    many: bool
    optional: bool
    required: bool
    duration: bool
    default: Any

    @property
    def text(self) -> Text:
        """What a text under this key must look like."""
        return _TEXTS.get(self.name, ANY)

    @property
    def range(self) -> tuple[int, int]:
        """The least and the greatest number that may stand under this key."""
        return _RANGES[self.name]


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
    return Key(
        name=field.name,
        item=get_args(hint)[0] if many or optional else hint,
        many=many,
        optional=optional,
        required=needed and field.name not in _DERIVED.get(noun, ()),
        duration=field.name in _DURATIONS,
        default=field.default,
    )


_SCHEMA = Key(
    name="schema",
    item=Schema,
    many=False,
    optional=False,
    required=False,
    duration=False,
    default=MISSING,
)
_KEYS = {noun: _keys(noun) for noun in NOUNS}
