"""The link between a guard and the security service: JSON messages, the same on both hops.

    guard ── Unix socket, a line each ── link process ── WebSocket, a frame each ── service

What comes from the other side is checked whole: WireError for everything that is not a message.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, TypeAdapter, ValidationError

from rtron.errors import WireError
from rtron.vocabulary import GuardEvent, GuardState, Plan, Settings

PROTOCOL = 1
MAX_EVENTS = 1000
"""The most events in one message."""
MAX_MESSAGE_BYTES = 1 << 22
"""The longest message, bytes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hello:
    """A guard begins to talk: who it is, what it guards, and the settings that it has in force.

    `robot` is filled in by the link process. `run` is this life of the guard, `began` (ns, wall).
    """

    app: str
    plan: Plan
    run: str
    began: int
    version: str
    robot: str = ""
    dry_run: bool = False
    settings: Settings = Settings()  # noqa: RUF009 - frozen
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
class Applied:
    """The guard has put settings in force, or `error` says why it has not."""

    revision: int
    error: str = ""
    type: Literal["applied"] = "applied"


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """All events of a run up to this number are safe, and need not be sent again."""

    run: str
    number: int
    type: Literal["stored"] = "stored"


@dataclass(frozen=True, slots=True, kw_only=True)
class NewSettings:
    """Settings to put in force; `now` is the sender's wall clock (ns), for what ends in time."""

    settings: Settings
    now: int
    type: Literal["settings"] = "settings"


FromGuard: TypeAlias = Annotated[
    Hello | Events | StateReport | Applied, Field(discriminator="type")
]
ToGuard: TypeAlias = Annotated[Stored | NewSettings, Field(discriminator="type")]

_FROM_GUARD: TypeAdapter[Any] = TypeAdapter(FromGuard)
_TO_GUARD: TypeAdapter[Any] = TypeAdapter(ToGuard)
_EVENT: TypeAdapter[GuardEvent] = TypeAdapter(GuardEvent)


def decode_from_guard(data: bytes | str) -> Hello | Events | StateReport | Applied:
    """Read what a guard says."""
    return _decode(_FROM_GUARD, data)  # type: ignore[no-any-return]


def decode_to_guard(data: bytes | str) -> Stored | NewSettings:
    """Read what is said to a guard."""
    return _decode(_TO_GUARD, data)  # type: ignore[no-any-return]


def encode_from_guard(message: Hello | Events | StateReport | Applied) -> bytes:
    """Write what a guard says, on one line without its end."""
    return _FROM_GUARD.dump_json(message)


def encode_to_guard(message: Stored | NewSettings) -> bytes:
    """Write what is said to a guard, on one line without its end."""
    return _TO_GUARD.dump_json(message)


def encode_event(event: GuardEvent) -> bytes:
    """Write one event."""
    return _EVENT.dump_json(event)


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
