"""What the recorder writes of an entry: messages as they were, decisions as JSON.

The channels of messages are the private topics of the guard, with the schemas of ROS; all
decisions are on one channel with a JSON Schema, told apart by `kind`.
"""

import json
import math
from collections.abc import Iterator
from typing import Any

from rtron.guard.core.message_types import standard_info
from rtron.guard.incidents.entries import (
    AlarmSwitched,
    ControlState,
    EntriesLost,
    Entry,
    EventMessage,
    LearnedType,
    LeaseAnswered,
    Observed,
    Received,
    RevisionChanged,
    RuleSwitched,
    Sent,
)
from rtron.guard.incidents.ring import Channel
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.vocabulary import GUARD_NODE, flow_topic, normalise_type, output_topic
from rtron.wire.common.incident_format import DECISIONS

LONGEST_DEFINITION = 1 << 18
"""The longest definition of a type that is kept, characters."""
_TEXTS = (
    "topic",
    "flow",
    "publisher",
    "owner",
    "decision",
    "policy",
    "reason",
    "stopping",
    "rule",
    "lease",
    "request",
    "alarm",
)
_SCHEMA = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "rtron.Decision",
    "description": "What a guard decided, what it depended on, and who was in command.",
    "type": "object",
    "required": ["kind"],
    "properties": {
        "kind": {
            "enum": [
                "verdict",
                "sent",
                "control",
                "rule",
                "lease",
                "observed",
                "alarm",
                "settings",
                "lost",
            ]
        },
        **{name: {"type": "string"} for name in _TEXTS},
        "bytes": {"type": "integer", "description": "the length of the message"},
        "revision": {"type": "integer", "description": "of the settings in force"},
        "limit": {"type": ["number", "null"], "description": "m/s"},
        "speed": {"type": ["number", "null"], "description": "m/s, of the last output"},
        "blocks": {"type": "boolean"},
        "granted": {"type": "boolean"},
        "active": {"type": "boolean"},
        "count": {"type": "integer"},
        "settings": {"type": "object"},
        "rates": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {
                    "id": {"type": "string"},
                    "fps": {"type": "number"},
                    "age": {"type": ["integer", "null"], "description": "of the last frame, ns"},
                },
            },
        },
        "events": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {
                    "name": {"type": "string"},
                    "publishers": {"type": "integer"},
                    "newest": {"type": ["integer", "null"], "description": "its age, ns"},
                    "judged": {"type": ["boolean", "null"]},
                    "triggered": {"type": ["integer", "null"], "description": "its age, ns"},
                    "true_count": {"type": "integer"},
                },
            },
        },
    },
}
DECISION_CHANNEL = Channel(
    DECISIONS, "json", "rtron.Decision", "jsonschema", json.dumps(_SCHEMA, separators=(",", ":"))
)
_KINDS = {
    ControlState: "control",
    RuleSwitched: "rule",
    LeaseAnswered: "lease",
    AlarmSwitched: "alarm",
}
"""The decisions that are written as they are."""
Written = tuple[Channel, bytes]


class EntryDocuments:
    """Turns entries into what is written; it knows the types of the streams from then on."""

    def __init__(self, encoding: Encoding) -> None:
        self._encoding = encoding
        self._types: dict[str, LearnedType] = {}
        self._publishers: dict[tuple[str, str], str] = {}
        self._channels: dict[tuple[str, str], Channel] = {}

    def learn(self, learned: LearnedType) -> None:
        """Take the type of a stream's messages, and whose its flows are."""
        self._types[learned.topic] = _writable(learned)
        for flow, publisher in learned.publishers:
            self._publishers[learned.topic, flow] = publisher
        stale = [key for key in self._channels if key[0] == learned.topic]
        for key in stale:
            del self._channels[key]

    def of(self, entry: Entry) -> Iterator[Written]:
        """Yield what is written of an entry."""
        if isinstance(entry, Received):
            yield from self._message(entry, entry.flow)
        elif isinstance(entry, Sent):
            yield from self._message(entry, "")
        elif isinstance(entry, EventMessage):
            yield self._event_channel(entry), self._body(entry.message)
        document = self._decision(entry)
        if document:
            text = json.dumps(document, separators=(",", ":"), allow_nan=False)
            yield DECISION_CHANNEL, text.encode()

    def _message(self, entry: Received | Sent, flow: str) -> Iterator[Written]:
        channel = self._channel(entry.topic, flow) if entry.message else None
        if channel:
            yield channel, self._body(entry.message)

    def _body(self, message: bytes) -> bytes:
        """Return a message as MCAP has it: of ROS 1 without its length."""
        return message[PREFIX:] if self._encoding is Encoding.ROS1 else message

    def _event_channel(self, entry: EventMessage) -> Channel:
        """Return the channel of a publisher's events: the topic as the app calls it."""
        key = (entry.topic, f"event of {entry.publisher}")
        if key not in self._channels:
            learned = _writable(LearnedType(entry.topic, *entry[3:6], publishers=()))
            self._channels[key] = self._channel_of(learned, entry.topic, entry.publisher)
        return self._channels[key]

    def _channel(self, topic: str, flow: str) -> Channel | None:
        """Return the channel of a flow, or of the output if `flow` is empty."""
        channel = self._channels.get((topic, flow))
        learned = self._types.get(topic)
        if channel is None and learned:
            channel = self._channels[topic, flow] = self._new_channel(learned, flow)
        return channel

    def _new_channel(self, learned: LearnedType, flow: str) -> Channel:
        topic = learned.topic
        if not flow:
            return self._channel_of(learned, output_topic(topic), GUARD_NODE)
        publisher = self._publishers.get((topic, flow), "")
        return self._channel_of(learned, flow_topic(topic, flow), publisher)

    def _channel_of(self, learned: LearnedType, name: str, publisher: str) -> Channel:
        is_ros1 = self._encoding is Encoding.ROS1
        standard = None if learned.definition else standard_info(learned.type, self._encoding)
        definition = learned.definition or (standard.definition if standard else "")
        format = "ros1msg" if is_ros1 else "ros2msg"
        md5sum = {"md5sum": learned.md5sum} if is_ros1 else {}
        return Channel(
            name,
            self._encoding.value,
            _schema_name(learned.type, is_ros1=is_ros1),
            format if definition else "",
            definition,
            tuple({"callerid": publisher, **md5sum}.items()),
        )

    def _decision(self, entry: Entry) -> dict[str, Any] | None:
        match entry:
            case Received():
                return self._verdict(entry)
            case Sent(topic=topic, flow=flow, size=size, stopping=stopping):
                if entry.message and not stopping:
                    return None
                return {
                    "kind": "sent", "topic": topic, "flow": flow, "bytes": size,
                    "stopping": stopping,
                }  # fmt: skip
            case Observed():
                return _observed(entry)
        return _document(entry)

    def _verdict(self, entry: Received) -> dict[str, Any]:
        return {
            "kind": "verdict",
            "topic": entry.topic,
            "flow": entry.flow,
            "publisher": self._publishers.get((entry.topic, entry.flow), ""),
            "owner": entry.owner,
            "decision": str(entry.decision),
            "policy": str(entry.policy),
            "reason": entry.reason,
            "revision": entry.revision,
            "bytes": entry.size,
        }


def _writable(learned: LearnedType) -> LearnedType:
    """Return what a publisher says of its type as UTF-8 can say it, without a text of megabytes."""
    definition = learned.definition if len(learned.definition) <= LONGEST_DEFINITION else ""
    texts = (learned.type, learned.md5sum, definition)
    type, md5sum, definition = (each.encode(errors="replace").decode() for each in texts)
    return learned._replace(type=type, md5sum=md5sum, definition=definition)


def _document(entry: Entry) -> dict[str, Any] | None:
    """Return what an entry says, with the names of its fields, but not when."""
    match entry:
        case RevisionChanged(_, revision, settings):
            return {"kind": "settings", "revision": revision, "settings": json.loads(settings)}
        case EntriesLost(_, number):
            return {"kind": "lost", "count": number}
    if type(entry) not in _KINDS:
        return None
    fields = {name: value for name, value in entry._asdict().items() if name != "at"}
    numbers = {name: _number(value) for name, value in fields.items() if isinstance(value, float)}
    return {"kind": _KINDS[type(entry)], **fields, **numbers}


def _observed(entry: Observed) -> dict[str, Any]:
    """Return rates and events with ages in place of times, which no other machine knows."""
    at = entry.at
    rates = [
        {"id": id, "fps": _number(fps) or 0.0, "age": at - last if last else None}
        for id, fps, last in entry.rates
    ]
    events = [
        {
            "name": name,
            "publishers": publishers,
            "newest": None if newest is None else at - newest,
            "judged": judged,
            "triggered": None if triggered is None else at - triggered,
            "true_count": true_count,
        }
        for name, publishers, newest, judged, triggered, true_count in entry.events
    ]
    return {"kind": "observed", "rates": rates, "events": events}


def _number(value: float | None) -> float | None:
    """Return a number that JSON has."""
    return value if value is not None and math.isfinite(value) else None


def _schema_name(type: str, *, is_ros1: bool) -> str:
    """Return a type in the spelling of its ROS."""
    name = normalise_type(type)
    package, _, last = name.rpartition("/")
    return name if is_ros1 or package.count("/") else f"{package}/msg/{last}"
