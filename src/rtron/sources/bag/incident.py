"""An incident's file, as the guard of some robot has saved it: what passed, and what decided it.

The file may come from anywhere. Its size, its chunks and its metadata are bounded as a bag's are, a
message counts as a velocity only if its definition says so, and decisions are plain JSON.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias

from pydantic import TypeAdapter, ValidationError

from rtron.errors import InputError, WireError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.pose import POSE_TYPES, GroundPose, pose_reader
from rtron.messages.common.velocity import VELOCITY_TYPES, velocity_codec
from rtron.sources.bag.common.reader import BagConnection, BagReader
from rtron.sources.bag.mcap.reader import open_mcap_with_metadata
from rtron.sources.bag.mcap.record import INCIDENT_ENCODINGS
from rtron.vocabulary import (
    PRIVATE_ROOT,
    SECOND,
    IncidentHeader,
    Plan,
    Settings,
    Velocity,
    normalise_type,
)
from rtron.wire.common.incident_format import DECISIONS, FORMER_SETTINGS, INCIDENT, PLAN, SETTINGS

OUTPUT = "out"
"""The last part of the name of a stream's private output."""
_LONGEST_DECISION = 1 << 20
_HELP = "give a file that a guard has saved; `rtron incident list` shows them"
_LONGEST = 3600 * SECOND
"""More than any guard keeps, ns."""
_HEADER: TypeAdapter[IncidentHeader] = TypeAdapter(IncidentHeader)
_PLAN: TypeAdapter[Plan] = TypeAdapter(Plan)
_SETTINGS: TypeAdapter[Settings] = TypeAdapter(Settings)


@dataclass(frozen=True, slots=True, kw_only=True)
class PassedMessage:
    """A message of a guarded topic at a time (ns, wall clock), with 4 bytes in front as in ROS.

    `flow` is empty for what went out. `publisher`, `type`, `md5sum` and `definition` are the
    recorded ones; `velocity` is None where the message is none.
    """

    at: int
    topic: str
    flow: str
    publisher: str
    data: bytes
    velocity: Velocity | None
    type: str
    md5sum: str = ""
    definition: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedDecision:
    """A decision at a time (ns, wall clock), as the JSON document that the guard wrote."""

    at: int
    document: Mapping[str, Any]

    def text(self, key: str) -> str:
        """Return a text of the document, "" if there is none under this key."""
        value = self.document.get(key)
        return value if isinstance(value, str) else ""

    def number(self, key: str) -> float | None:
        """Return a number of the document, None if there is none under this key."""
        value = self.document.get(key)
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return float(value) if is_number else None  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedPose:
    """Where something was at a time (ns, wall clock), as a message of a topic said."""

    at: int
    topic: str
    pose: GroundPose


IncidentEntry: TypeAlias = PassedMessage | RecordedDecision | RecordedPose


class IncidentFile:
    """An open incident; InputError if the file is none, also while its entries are read."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._reader, self._metadata = open_mcap_with_metadata(path, INCIDENT_ENCODINGS)
        self.header: IncidentHeader = self._decoded(decode_header)

    @cached_property
    def plan(self) -> tuple[Plan, Settings]:
        """The plan and the settings that were in force when the incident was saved."""
        found: tuple[Plan, Settings] = self._decoded(decode_plan)
        return found

    @property
    def former_settings(self) -> Settings | None:
        """The settings before those, None if the guard has recorded no change."""
        found: Settings | None = self._decoded(decode_former_settings)
        return found

    @property
    def definitions(self) -> dict[str, str]:
        """The definitions that the file has of the types in it, by type."""
        texts = {on.type: on.definition for on in self._reader.connections}
        return {type: text for type, text in texts.items() if text}

    @property
    def encoding(self) -> Encoding:
        """How the messages are encoded."""
        return Encoding.ROS1 if self.header.ros == 1 else Encoding.CDR

    def entries(self) -> Iterator[IncidentEntry]:
        """Yield messages and decisions in the order of time."""
        reader: BagReader = self._reader
        makers = {on: self._maker(on) for on in reader.connections}
        for time, on, data in reader:
            if not self.header.begin <= time <= self.header.end:
                message = "it has messages of another time than it says"
                raise InputError(message, path=str(self.path), help=_HELP)
            if (make := makers[on]) and (entry := make(time, data)):
                yield entry

    def velocity_readers(self) -> dict[str, Callable[[bytes], Velocity | None]]:
        """Return what reads the velocity in a message of each guarded topic."""
        return {
            place[0]: _velocity_reader(on, self.encoding)
            for on in self._reader.connections
            if (place := self._place(on))
        }

    def _maker(self, on: BagConnection) -> Callable[[int, bytes], IncidentEntry | None] | None:
        """Return what makes an entry of a channel's messages; None if they are left out."""
        if on.topic == DECISIONS and on.encoding == "json":
            return self._decision
        place = self._place(on)
        return self._message_maker(on, *place) if place else self._pose_maker(on)

    def _place(self, on: BagConnection) -> tuple[str, str] | None:
        """Return the guarded topic and the flow of a channel, None if it is of no guard."""
        topic, _, flow = on.topic.removeprefix(PRIVATE_ROOT).rpartition("/")
        is_private = on.topic.startswith(f"{PRIVATE_ROOT}/") and bool(topic)
        if not is_private or on.encoding != self.encoding.value:
            return None
        return topic, "" if flow == OUTPUT else flow

    def _message_maker(
        self, on: BagConnection, topic: str, flow: str
    ) -> Callable[[int, bytes], PassedMessage]:
        read = _velocity_reader(on, self.encoding)

        def make(time: int, data: bytes) -> PassedMessage:
            framed = self._framed(data)
            return PassedMessage(
                at=time,
                topic=topic,
                flow=flow,
                publisher=on.callerid,
                data=framed,
                velocity=read(framed),
                type=normalise_type(on.type),
                md5sum=on.md5sum,
                definition=on.definition,
            )

        return make

    def _pose_maker(self, on: BagConnection) -> Callable[[int, bytes], RecordedPose | None] | None:
        """Return what makes a pose of an event's message; None if it tells of none."""
        if normalise_type(on.type) not in POSE_TYPES or on.encoding != self.encoding.value:
            return None
        try:
            read = pose_reader(parse_definition(on.type, on.definition), self.encoding)
        except InputError:
            return None
        if read is None:
            return None

        def make(time: int, data: bytes) -> RecordedPose | None:
            try:
                return RecordedPose(at=time, topic=on.topic, pose=read(self._framed(data)))
            except WireError:
                return None

        return make

    def _framed(self, data: bytes) -> bytes:
        """Return a message with the 4 bytes in front that MCAP leaves out in ROS 1."""
        return Encoding.ROS1.prefix(len(data)) + data if self.header.ros == 1 else data

    def _decision(self, time: int, data: bytes) -> RecordedDecision:
        try:
            document = _read_document(data)
        except (ValueError, RecursionError) as error:
            raise InputError(
                f"a decision is no JSON: {str(error)[:100]}", path=str(self.path), help=_HELP
            ) from None
        return RecordedDecision(at=time, document=document)

    def _decoded(self, decode: Callable[[Mapping[str, Mapping[str, str]]], Any]) -> Any:  # noqa: ANN401 - as `decode` says
        try:
            return decode(self._metadata)
        except WireError as error:
            raise InputError(f"no incident: {error}", path=str(self.path), help=_HELP) from None


def _read_document(data: bytes) -> dict[str, Any]:
    """Return a JSON object; ValueError or RecursionError if it is none, or no JSON can say it."""
    if len(data) > _LONGEST_DECISION:
        raise ValueError(f"{len(data)} bytes")
    document = json.loads(data, parse_float=_finite, parse_int=_whole, parse_constant=_finite)
    if not isinstance(document, dict):
        raise ValueError("no object")  # noqa: TRY004 - of the file, not of the program
    return document


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is no number")
    return value


def _whole(text: str) -> int:
    _finite(text)
    return int(text)


def _velocity_reader(on: BagConnection, encoding: Encoding) -> Callable[[bytes], Velocity | None]:
    """Return what reads the velocity in the messages of a channel."""
    if normalise_type(on.type) not in VELOCITY_TYPES:
        return _no_velocity
    try:
        codec = velocity_codec(parse_definition(on.type, on.definition), encoding)
    except InputError:
        return _no_velocity
    if codec is None:
        return _no_velocity

    def read(message: bytes) -> Velocity | None:
        try:
            return codec.decode(message)
        except WireError:
            return None

    return read


def _no_velocity(_message: bytes) -> None:
    """Return no velocity."""


def decode_header(metadata: Mapping[str, Mapping[str, str]]) -> IncidentHeader:
    """Return what an incident is about; WireError if the file is none."""
    header: IncidentHeader = _decode(_HEADER, metadata, INCIDENT)
    if not header.causes:
        raise WireError("it names no cause")
    if not 0 <= header.begin <= header.causes[0].at < 1 << 63 or not (
        header.begin <= header.end <= header.begin + _LONGEST
    ):
        raise WireError("its times are no guard's")
    return header


def decode_plan(metadata: Mapping[str, Mapping[str, str]]) -> tuple[Plan, Settings]:
    """Return the plan and the settings that were in force."""
    return _decode(_PLAN, metadata, PLAN), _decode(_SETTINGS, metadata, SETTINGS)


def decode_former_settings(metadata: Mapping[str, Mapping[str, str]]) -> Settings | None:
    """Return the settings that were in force before those; None if they are not known."""
    if FORMER_SETTINGS not in metadata:
        return None
    settings: Settings = _decode(_SETTINGS, metadata, FORMER_SETTINGS)
    return settings


def _decode(adapter: TypeAdapter[Any], metadata: Mapping[str, Mapping[str, str]], name: str) -> Any:  # noqa: ANN401 - as the adapter says
    text = metadata.get(name, {}).get("json")
    if text is None:
        raise WireError(f"it has no metadata {name}")
    try:
        return adapter.validate_json(text)
    except (ValidationError, RecursionError) as error:
        where = (
            error.errors(include_url=False, include_input=False)[0]["loc"]
            if isinstance(error, ValidationError)
            else ()
        )
        raise WireError(f"{name} is not as it should be: {'.'.join(map(str, where))}") from None
