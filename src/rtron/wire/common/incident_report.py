"""What a robot tells its service of an incident: what decided, and speeds and paths, reduced.

All speeds share one grid of times, so a report has a bound whatever the incident has. What comes
from a robot is checked whole against these bounds. Times are in seconds after the first cause.
"""

from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, TypeAdapter

MAX_REPORT_BYTES = 1 << 20
"""The longest report, bytes of JSON; the bounds below leave none that is longer."""
MAX_TEXT, MAX_SENTENCE = 160, 400
MAX_POINTS, MAX_PLACES = 300, 200
MAX_CAUSES, MAX_TOPICS, MAX_FLOWS, MAX_CHANGES, MAX_OWNERS, MAX_EVENTS = 20, 4, 8, 20, 20, 40
MAX_AREAS, MAX_CORNERS, MAX_ALTERNATIVES, MAX_NOTES = 10, 30, 2, 4
MAX_NUMBER = 1e6
"""The largest number of a report: m, m/s or s."""

_NO_CONTROLS = r"^[^\x00-\x1f\x7f]*$"
Text: TypeAlias = Annotated[str, Field(max_length=MAX_TEXT, pattern=_NO_CONTROLS)]
Sentence: TypeAlias = Annotated[str, Field(max_length=MAX_SENTENCE, pattern=_NO_CONTROLS)]
FileName: TypeAlias = Annotated[str, Field(pattern=r"^[0-9A-Za-z][0-9A-Za-z._-]{0,119}\.mcap$")]
Number: TypeAlias = Annotated[
    float, Field(ge=-MAX_NUMBER, le=MAX_NUMBER, allow_inf_nan=False, strict=True)
]
Count: TypeAlias = Annotated[int, Field(ge=0, lt=1 << 53, strict=True)]
Nanoseconds: TypeAlias = Annotated[int, Field(ge=0, lt=1 << 63, strict=True)]
Speeds: TypeAlias = Annotated[tuple[Number | None, ...], Field(max_length=MAX_POINTS)]
"""The fastest speed in each step of the grid, m/s; None where nothing was in force."""
Place: TypeAlias = tuple[Number, Number]
"""x and y, m."""
Path: TypeAlias = Annotated[tuple[Place, ...], Field(max_length=MAX_PLACES)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedCause:
    """Why the incident was saved."""

    at: Number
    kind: Literal["intervention", "stop", "alarm"]
    topic: Text
    flow: Text
    reason: Text


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedFlow:
    """What one flow commanded, and the number of its messages for each verdict."""

    flow: Text
    publisher: Text
    verdicts: dict[Literal["pass", "hold", "drop", "modify"], Count]
    speeds: Speeds


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedOwner:
    """Who was in command from a time on, and why the robot was being stopped."""

    at: Number
    owner: Text
    publisher: Text
    stopping: Text


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedChange:
    """A verdict on a flow that differs from the one before."""

    at: Number
    flow: Text
    decision: Text
    policy: Text
    reason: Text


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedTopic:
    """What was commanded and what went out on a guarded topic; `left_out` are further changes."""

    topic: Text
    flows: Annotated[tuple[ReportedFlow, ...], Field(max_length=MAX_FLOWS)]
    output: Speeds
    limits: Speeds
    owners: Annotated[tuple[ReportedOwner, ...], Field(max_length=MAX_OWNERS)]
    changes: Annotated[tuple[ReportedChange, ...], Field(max_length=MAX_CHANGES)]
    left_out: Count


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedEvent:
    """An alarm, a rule, settings or a loss."""

    at: Number
    kind: Text
    topic: Text
    reason: Text


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedArea:
    """An area of the plan in the frame of the path."""

    name: Text
    polygon: Annotated[tuple[Place, ...], Field(max_length=MAX_CORNERS)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedAlternative:
    """What would have gone out, by topic, and where the robot would have been."""

    title: Text
    sentences: Annotated[tuple[Sentence, ...], Field(max_length=MAX_TOPICS)]
    notes: Annotated[tuple[Text, ...], Field(max_length=MAX_NOTES)]
    outputs: Annotated[dict[Text, Speeds], Field(max_length=MAX_TOPICS)]
    path: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentReport:
    """An incident that a robot has saved in a file of this name, of `size` bytes.

    `at` is the robot's wall clock at the first cause, ns. The grid of speeds begins at `begin` and
    has steps of `step` seconds. `owner` and `publisher` were in command at the gravest cause.
    `path` is in `frame`; without a frame it is dead reckoning of what went out.
    """

    name: FileName
    size: Count
    at: Nanoseconds
    app: Text
    ros: Literal[1, 2]
    distribution: Text
    rtron: Text
    revision: Nanoseconds
    gravest: ReportedCause
    owner: Text
    publisher: Text
    causes: Annotated[tuple[ReportedCause, ...], Field(min_length=1, max_length=MAX_CAUSES)]
    omitted_causes: Count
    begin: Number
    step: Annotated[float, Field(gt=0, le=MAX_NUMBER, allow_inf_nan=False, strict=True)]
    topics: Annotated[tuple[ReportedTopic, ...], Field(max_length=MAX_TOPICS)]
    omitted_topics: Count
    events: Annotated[tuple[ReportedEvent, ...], Field(max_length=MAX_EVENTS)]
    omitted_events: Count
    frame: Text
    path: Path
    areas: Annotated[tuple[ReportedArea, ...], Field(max_length=MAX_AREAS)]
    alternatives: Annotated[tuple[ReportedAlternative, ...], Field(max_length=MAX_ALTERNATIVES)]
    schema: Literal["rtron.incident_report/1"] = "rtron.incident_report/1"


@cache
def _adapter() -> TypeAdapter[IncidentReport]:
    return TypeAdapter(IncidentReport)


def encode_report(report: IncidentReport) -> bytes:
    """Write a report as JSON, on one line."""
    return _adapter().dump_json(report)


def report_document(report: IncidentReport) -> dict[str, Any]:
    """Return a report as a JSON document."""
    document: dict[str, Any] = _adapter().dump_python(report, mode="json")
    return document
