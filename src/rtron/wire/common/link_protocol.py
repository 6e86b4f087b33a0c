"""The link between a guard and the security service: JSON messages, the same on both hops.

    guard ── Unix socket, a line each ── link process ── WebSocket, a frame each ── service

What comes from the other side is checked whole: WireError for everything that is not a message.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, TypeAdapter, ValidationError

from rtron.errors import WireError
from rtron.vocabulary import GuardEvent, GuardState, OpenRequests, Plan, Settings
from rtron.wire.common.incident_report import FileName, IncidentReport

PROTOCOL = 1
MAX_EVENTS = 1000
"""The most events in one message."""
MAX_HELD_HEADS = 8
"""The most documents of heads in a hello."""
MAX_MESSAGE_BYTES = 1 << 22
"""The longest message, bytes."""
MAX_PLAN_LENGTH = 1 << 18
"""The longest plan document that goes out to robots, characters."""


LeaseAction: TypeAlias = Literal["give", "renew", "end"]
"""What a person may do with a lease: give it to a commander, renew what was given, end it."""
ApprovalAction: TypeAlias = Literal["approve", "refuse"]
"""What a person may do with a request of a bridge's client."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hello:
    """A guard begins to talk: who it is, what it guards, and the settings that it has in force.

    `robot` is filled in by the link process, and what it takes of the service: `renews_token` a
    `RenewedToken`, `takes_audit_heads` the `AuditHeads`, of which `held_heads` are some that it
    keeps, `takes_refusals` the `EventsRefused`, `takes_lease_commands` the `LeaseCommand`, and
    `takes_approval_commands` the `ApprovalCommand`.
    `run` is this life of the guard, `began` (ns, wall).
    """

    app: str
    plan: Plan
    run: str
    began: int
    version: str
    robot: str = ""
    dry_run: bool = False
    settings: Settings = Settings()  # noqa: RUF009 - frozen
    renews_token: bool = False
    takes_audit_heads: bool = False
    takes_refusals: bool = False
    takes_lease_commands: bool = False
    takes_approval_commands: bool = False
    held_heads: Annotated[tuple[dict[str, Any], ...], Field(max_length=MAX_HELD_HEADS)] = ()
    protocol: int = PROTOCOL
    type: Literal["hello"] = "hello"

    @property
    def revision(self) -> int:
        """The revision in force."""
        return self.settings.revision


@dataclass(frozen=True, slots=True, kw_only=True)
class Events:
    """Events in the order of their numbers; `Stored` answers once they are safe."""

    events: tuple[GuardEvent, ...]
    type: Literal["events"] = "events"


@dataclass(frozen=True, slots=True, kw_only=True)
class StateReport:
    """What the guard is at now; not kept, and not answered."""

    state: GuardState
    type: Literal["state"] = "state"


@dataclass(frozen=True, slots=True, kw_only=True)
class StateDelta:
    """What differs from the last state on this connection, to a service that takes changes.

    `state` has only the streams that differ; of the fields `unchanged` it has nothing.
    """

    state: GuardState
    unchanged: tuple[str, ...] = ()
    type: Literal["state_delta"] = "state_delta"


@dataclass(frozen=True, slots=True, kw_only=True)
class Applied:
    """The guard has put settings in force, or `error` says why it has not.

    `plan` is the digest of the plan document in force, as `Settings` has it.
    """

    revision: int
    error: str = ""
    plan: str = ""
    type: Literal["applied"] = "applied"


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandResponse:
    """What a guard or a bridge has made of the command of this number, and why."""

    number: int
    granted: bool
    reason: str
    type: Literal["command_response"] = "command_response"


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """All events of a run up to this number are safe, and need not be sent again."""

    run: str
    number: int
    type: Literal["stored"] = "stored"


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentSaved:
    """The robot has saved an incident; `IncidentStored` answers, and then the next one may come."""

    report: IncidentReport
    type: Literal["incident"] = "incident"


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentStored:
    """The service has the report of the incident of this name."""

    name: FileName
    type: Literal["incident_stored"] = "incident_stored"


@dataclass(frozen=True, slots=True, kw_only=True)
class EventsRefused:
    """Events cannot be stored now: all that are not `Stored` are to come again, in a while."""

    type: Literal["events_refused"] = "events_refused"


@dataclass(frozen=True, slots=True, kw_only=True)
class NewSettings:
    """Settings to put in force; `now` is the sender's clock (ns), for what ends in time.

    The service has its wall clock. On the robot it is the machine's time since its start, of which
    `boot` is the one; that is in the file of settings only. `takes_state_deltas`: the service takes
    a `StateDelta`; one that does not say so gets whole states. `takes_incidents`: an
    `IncidentSaved`, too; `takes_requests`: states with the bridge's `requests`.
    """

    settings: Settings
    now: int
    boot: str = ""
    takes_state_deltas: bool = False
    takes_incidents: bool = False
    takes_requests: bool = False
    type: Literal["settings"] = "settings"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanRequest:
    """The robot lacks the plan document of this digest, which its settings name."""

    digest: str
    type: Literal["plan_request"] = "plan_request"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanDocument:
    """A plan document that was asked for, as `rtron.yaml` has it."""

    text: Annotated[str, Field(max_length=MAX_PLAN_LENGTH)]
    type: Literal["plan_document"] = "plan_document"


@dataclass(frozen=True, slots=True, kw_only=True)
class RenewedToken:
    """The next secret of the guard's token; the one before holds until `RenewedTokenStored`."""

    token: str = field(repr=False)
    type: Literal["renewed_token"] = "renewed_token"


@dataclass(frozen=True, slots=True, kw_only=True)
class RenewedTokenStored:
    """The link process has the renewed token on disk, and connects with it from now on."""

    type: Literal["renewed_token_stored"] = "renewed_token_stored"


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditHeads:
    """Signed heads of the service's audit log (`rtron.audit_heads/1`), for a link to keep."""

    document: dict[str, Any]
    type: Literal["audit_heads"] = "audit_heads"


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaseCommand:
    """A person says who is in command: `to` is whom to give a lease to, while `grant` holds it.

    It is done at once or not at all. `number` is for the `CommandResponse`.
    """

    number: int
    lease: str
    do: LeaseAction
    by: str
    grant: int
    to: str = ""
    reason: str = ""
    type: Literal["lease_command"] = "lease_command"


@dataclass(frozen=True, slots=True, kw_only=True)
class ApprovalCommand:
    """A person, who has `roles` at the service, answers the request of this `digest`.

    It is for the bridge, done at once or not at all. `number` is for the `CommandResponse`.
    """

    number: int
    digest: str
    do: ApprovalAction
    by: str
    roles: tuple[str, ...]
    reason: str
    type: Literal["approval_command"] = "approval_command"


PersonCommand: TypeAlias = LeaseCommand | ApprovalCommand
"""What a person at the service asks for, and a `CommandResponse` answers."""


FromGuard: TypeAlias = Annotated[
    Hello
    | Events
    | StateReport
    | StateDelta
    | Applied
    | CommandResponse
    | IncidentSaved
    | PlanRequest
    | RenewedTokenStored,
    Field(discriminator="type"),
]
ToGuard: TypeAlias = Annotated[
    Stored
    | EventsRefused
    | IncidentStored
    | NewSettings
    | LeaseCommand
    | ApprovalCommand
    | PlanDocument
    | RenewedToken
    | AuditHeads,
    Field(discriminator="type"),
]


@cache
def _from_guard() -> TypeAdapter[Any]:
    return TypeAdapter(FromGuard)


@cache
def _to_guard() -> TypeAdapter[Any]:
    return TypeAdapter(ToGuard)


@cache
def _approval_command() -> TypeAdapter[ApprovalCommand]:
    return TypeAdapter(ApprovalCommand)


@cache
def _open_requests() -> TypeAdapter[OpenRequests]:
    return TypeAdapter(OpenRequests)


@cache
def _event() -> TypeAdapter[GuardEvent]:
    return TypeAdapter(GuardEvent)


def prepare_codecs() -> None:
    """Make now what reads and writes messages, which takes up to a tenth of a second.

    Otherwise the first message does; a guard without a service needs none of it at its start.
    """
    for make in (_from_guard, _to_guard, _event):
        make()


def decode_from_guard(data: bytes | str) -> FromGuard:
    """Read what a guard says."""
    return _decode(_from_guard(), data)  # type: ignore[no-any-return]


def decode_to_guard(data: bytes | str) -> ToGuard:
    """Read what is said to a guard."""
    return _decode(_to_guard(), data)  # type: ignore[no-any-return]


def encode_from_guard(message: FromGuard) -> bytes:
    """Write what a guard says, on one line without its end."""
    return _from_guard().dump_json(message)


def encode_to_guard(message: ToGuard) -> bytes:
    """Write what is said to a guard, on one line without its end."""
    return _to_guard().dump_json(message)


def decode_approval_command(document: Mapping[str, Any]) -> ApprovalCommand:
    """Read what a link process says to a bridge."""
    return _decode(_approval_command(), json.dumps(document))  # type: ignore[no-any-return]


def decode_open_requests(data: bytes) -> OpenRequests:
    """Read which requests a bridge has open."""
    return _decode(_open_requests(), data)  # type: ignore[no-any-return]


def plan_document_digest(text: str) -> str:
    """Return what tells one plan document from another: its SHA-256, hex."""
    return sha256(text.encode()).hexdigest()


def encode_event(event: GuardEvent) -> bytes:
    """Write one event."""
    return _event().dump_json(event)


def encode_incident(report: bytes) -> bytes:
    """Write the message `IncidentSaved` of a report that is written already."""
    return b'{"type":"incident","report":' + report + b"}"


def encode_events(encoded: Iterable[bytes]) -> bytes:
    """Write the message `Events` of events that are written already."""
    return b'{"type":"events","events":[' + b",".join(encoded) + b"]}"


def _decode(adapter: TypeAdapter[Any], data: bytes | str) -> Any:  # noqa: ANN401 - as the adapter says
    if len(data) > MAX_MESSAGE_BYTES:
        raise WireError(f"a message of {len(data)} bytes, the most is {MAX_MESSAGE_BYTES}")
    try:
        return adapter.validate_json(data)
    except (ValidationError, RecursionError) as error:
        raise WireError(f"not a message of the link: {_error_text(error)}") from None


def _error_text(error: ValidationError | RecursionError) -> str:
    if isinstance(error, RecursionError):
        return "too deep"
    first = error.errors(include_url=False, include_input=False)[0]
    return f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
