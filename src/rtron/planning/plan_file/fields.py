"""How the nouns of a plan are written in its file: keys, what each holds, what may be left out.

The reader, the writer and the JSON Schema all follow this form, so that they agree.
"""

import re
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields
from types import UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from rtron.coherence.duration_bounds import DURATION_RANGES
from rtron.planning.plan_file.quantities import (
    ACCELERATION,
    ANGULAR_DECELERATION,
    ANGULAR_VELOCITY,
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
    Area,
    Audit,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    IncidentRecording,
    LeaseGroup,
    MessageDefinition,
    MissionRule,
    Plan,
    Point,
    StopButton,
    StopProfile,
    StopSources,
    StringEnum,
    Supervision,
    Transform,
    UnguardedPath,
    WatchedFlow,
)

T = TypeVar("T")
_NAME = "[A-Za-z0-9_]+"
_WORD = "[A-Za-z][A-Za-z0-9_]*"
# A line end would forge lines of a log, and a mark that turns the writing round other names.
UNSAFE_CHARACTERS = r"\x00-\x1f\x7f-\x9f\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff"
_APP_PART = rf"(?!(\s*|\.{{1,2}})(/|$))[^/{UNSAFE_CHARACTERS}]+"
_FRAME = "/?[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*"
_TYPE = rf"{_WORD}/((msg|action)/)?{_WORD}"
# The keywords and reserved words of CEL, the language of the expressions.
_CEL_KEYWORDS = (
    "true|false|null|in|as|break|const|continue|else|for|function|if|import|let|loop|package"
    "|namespace|return|var|void|while"
)


@dataclass(frozen=True, slots=True)
class TextFormat:
    """What a text must look like, as an expression and in words."""

    pattern: str
    description: str
    max_length: int = 255

    def matches(self, text: str) -> bool:
        """Tell whether a text looks like that."""
        return len(text) <= self.max_length and re.fullmatch(self.pattern, text) is not None


TOPIC_NAME = TextFormat(rf"(/{_NAME})+", "a full topic name like /cmd_vel")
NODE_NAME = TextFormat(
    r"(/[A-Za-z0-9_*]+)+", "a full node name like /move_base, `*` for what changes"
)
TYPE_NAME = TextFormat(rf"({_TYPE})?", "a message type like pkg/Name")
APP_NAME = TextFormat(
    rf"{_APP_PART}(/{_APP_PART})*",
    "an app's name like my_robot: one line, 200 characters at most, no `..`, no / at an end",
    max_length=200,
)
IDENTIFIER = TextFormat(_WORD, "a word of letters, digits and _")
ANY_TEXT = TextFormat(r"[\s\S]*", "a text of at most 1000 characters", max_length=1000)
_VARIABLE = TextFormat(
    rf"(?!({_CEL_KEYWORDS})$){_WORD}", "a word of letters, digits and _ that expressions leave free"
)
_FLOW = TextFormat(
    rf"((/{_NAME})+|{_WORD})", "a full topic name like /cmd_vel or the name of a flow"
)
_EXPRESSION = TextFormat(
    r"(\s*\S[\s\S]*)?", "an expression of at most 4096 characters", max_length=4096
)

# What a text under a key looks like, and under one noun's key where it differs.
_TEXTS = {
    "app": APP_NAME,
    "topic": TOPIC_NAME,
    "done": TOPIC_NAME,
    "publisher": NODE_NAME,
    "node": NODE_NAME,
    "successors": NODE_NAME,
    "cell": TextFormat(rf"(/{_NAME})+", "a full node name like /base"),
    "type": TYPE_NAME,
    "MessageDefinition.type": TextFormat(_TYPE, TYPE_NAME.description),
    "name": IDENTIFIER,
    "EventFlow.name": _VARIABLE,
    "Area.name": _VARIABLE,
    "id": IDENTIFIER,
    "lease": TextFormat(rf"({_WORD})?", IDENTIFIER.description),
    "when": _EXPRESSION,
    "action": _EXPRESSION,
    "definition": TextFormat(r"[\s\S]*", "a text of at most 65536 characters", max_length=65536),
    "frame": TextFormat(rf"({_FRAME})?", "a frame like map"),
    "Area.frame": TextFormat(_FRAME, "a frame like map"),
    "source": TextFormat(_FRAME, "a frame like odom"),
    "target": TextFormat(_FRAME, "a frame like map"),
    "block": _FLOW,
    "uses": TextFormat("(linear|angular)\\.[xyz]", "a component of a Twist like linear.x"),
    "require": TextFormat(rf"{_FLOW.pattern}?", _FLOW.description),
}
# Lists whose absence means all: an empty one would read as none.
_NEVER_EMPTY = {"uses": "the base would obey all components; leave the key out, or name some"}
_RANGES = {
    "ros": (1, 2),
    "revision": (0, 2**63 - 1),
    "priority": (-(2**31), 2**31 - 1),
    "queue_size": (1, 1_000_000),
    "megabytes": (16, 1_000_000),
}
_QUANTITIES = {
    "threshold": PER_FRAME,
    "max_vel_limit": VELOCITY,
    "max_turn_limit": ANGULAR_VELOCITY,
    "max_side_limit": VELOCITY,
    "max_accel_limit": ACCELERATION,
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
PLAN_TYPES: Mapping[type, str] = {
    Plan: "the plan",
    GRCN: "a GRCN",
    RSRCN: "the RSRCN",
    MSRCN: "the MSRCN",
    GuardedTopic: "a guarded topic",
    Flow: "a flow",
    WatchedFlow: "a watched flow",
    EventFlow: "an eflow",
    MissionRule: "a rule",
    Area: "an area",
    Point: "a point",
    Transform: "a transform",
    FpsMonitor: "an fps_monitor",
    LeaseGroup: "a lease",
    StopSources: "the stop sources",
    StopButton: "a stop button",
    StopProfile: "the stop",
    Audit: "the audit",
    Supervision: "the supervision",
    IncidentRecording: "the recording of incidents",
    MessageDefinition: "a message definition",
    UnguardedPath: "an unguarded command",
}


class PlanSchema(StringEnum):
    """What a plan file says that it is."""

    PLAN = PLAN_SCHEMA


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanField:
    """A key of a noun and what it holds: `item_type` itself, or a list of such if `is_list`.

    `text` is what a text must look like, `range` the least and greatest number or duration (ns).
    `if_empty` says what an empty list would mean where it may not stand.
    """

    name: str
    item_type: Any
    is_list: bool
    is_optional: bool
    is_required: bool
    default: Any
    text: TextFormat = ANY_TEXT
    range: tuple[int, int] = (0, 0)
    is_duration: bool = False
    quantity: Quantity | None = None
    if_empty: str = ""


def plan_fields(plan_type: type) -> Mapping[str, PlanField]:
    """Return the keys of a noun, in the order in which they are written."""
    return _FIELDS[plan_type]


def _make_fields(plan_type: type) -> Mapping[str, PlanField]:
    hints = get_type_hints(plan_type)
    made = {
        field.name: _make_field(plan_type, field, hints[field.name]) for field in fields(plan_type)
    }
    return {_SCHEMA.name: _SCHEMA, **made} if plan_type is Plan else made


def _make_field(plan_type: type, field: Field[Any], hint: Any) -> PlanField:  # noqa: ANN401 - a type hint
    is_list = get_origin(hint) is tuple
    is_optional = isinstance(hint, UnionType)
    has_no_default = field.default is MISSING and field.default_factory is MISSING
    item = get_args(hint)[0] if is_list or is_optional else hint
    full_name = f"{plan_type.__name__}.{field.name}"
    duration_range = _look_up(DURATION_RANGES, full_name) if item is int else None
    return PlanField(
        name=field.name,
        item_type=item,
        is_list=is_list,
        is_optional=is_optional,
        is_required=has_no_default and field.name not in _DERIVED.get(plan_type, ()),
        default=field.default,
        text=_look_up(_TEXTS, full_name) or ANY_TEXT,
        range=duration_range or _RANGES.get(field.name, (0, 0)),
        is_duration=duration_range is not None,
        quantity=_QUANTITIES[field.name] if item is float else None,
        if_empty=_NEVER_EMPTY.get(field.name, ""),
    )


def _look_up(table: Mapping[str, T], name: str) -> T | None:
    """Return what a table says of one noun's key, or else of the key under every noun."""
    return table.get(name) or table.get(name.partition(".")[2])


_SCHEMA = PlanField(
    name="schema",
    item_type=PlanSchema,
    is_list=False,
    is_optional=False,
    is_required=False,
    default=MISSING,
)
_FIELDS = {noun: _make_fields(noun) for noun in PLAN_TYPES}
