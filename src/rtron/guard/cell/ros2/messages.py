"""What a process of the guard and its carrier in a cell tell each other, as checked JSON.

Who has taken over a process in the cell gets no further by it: what comes out of a cell is never
unpickled, and only the kinds of `FromCarrier` are read.
"""

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, Union

from pydantic import Field, TypeAdapter, ValidationError

from rtron.errors import WireError
from rtron.guard.transport.common.protocol import OutputOptions, Peer, TypeInfo
from rtron.vocabulary import QoS


@dataclass(frozen=True, slots=True)
class Introduce:
    """Who is there: the first message, with a role of `CellAccess`."""

    role: str
    kind: Literal["introduce"] = "introduce"


@dataclass(frozen=True, slots=True)
class Beat:
    """The sender is alive; a carrier answers with the same."""

    kind: Literal["beat"] = "beat"


@dataclass(frozen=True, slots=True, kw_only=True)
class Publish:
    """Publish a topic inside, as is known of it by now; see `Output` for what each field is."""

    id: int
    node: str
    topic: str
    type: str
    options: OutputOptions
    info: TypeInfo | None = None
    matched: tuple[str, ...] = ()
    offers: dict[str, QoS] = field(default_factory=dict)
    is_greeting: bool = False
    kind: Literal["publish"] = "publish"


@dataclass(frozen=True, slots=True)
class ClearLatched:
    """Latch no message any more."""

    id: int
    kind: Literal["clear"] = "clear"


@dataclass(frozen=True, slots=True, kw_only=True)
class Subscribe:
    """Subscribe a topic inside, and pass on what each publisher sends."""

    id: int
    node: str
    topic: str
    type: str
    publishers: tuple[str, ...]
    queue_size: int
    keep_all: bool
    kind: Literal["subscribe"] = "subscribe"


@dataclass(frozen=True, slots=True)
class OfferService:
    """Offer a service inside, or do so no more; its requests come with the number of the call."""

    id: int
    node: str
    service: str
    type: str
    is_offered: bool
    kind: Literal["offer_service"] = "offer_service"


@dataclass(frozen=True, slots=True)
class CallService:
    """Call a service inside; requests are sent with the number of the call."""

    id: int
    node: str
    service: str
    type: str
    kind: Literal["call_service"] = "call_service"


@dataclass(frozen=True, slots=True)
class Look:
    """Tell who is in the cell, and who speaks and listens on topics; see `Seen`."""

    topics: tuple[str, ...]
    kind: Literal["look"] = "look"


@dataclass(frozen=True, slots=True)
class NewSubscriber:
    """There is a new subscriber of an output, which is to be greeted."""

    id: int
    kind: Literal["new_subscriber"] = "new_subscriber"


@dataclass(frozen=True, slots=True)
class Subscribers:
    """The nodes that subscribe an output now."""

    id: int
    nodes: frozenset[str]
    kind: Literal["subscribers"] = "subscribers"


@dataclass(frozen=True, slots=True)
class PublisherFound:
    """A publisher of a subscription, by the number of its connection."""

    subscription: int
    connection: int
    peer: Peer
    kind: Literal["found"] = "found"


@dataclass(frozen=True, slots=True)
class PublisherLost:
    """A publisher is gone."""

    connection: int
    kind: Literal["lost"] = "lost"


@dataclass(frozen=True, slots=True)
class ServiceState:
    """Whether a service that is called is there."""

    id: int
    is_available: bool
    kind: Literal["service_state"] = "service_state"


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenEndpoint:
    """An endpoint inside; see `Ros2Endpoint`. The GID is in hexadecimal digits."""

    topic: str
    is_publisher: bool
    node: str
    type: str
    gid: str
    qos: QoS


@dataclass(frozen=True, slots=True)
class Seen:
    """The endpoints on the topics that were asked for, and the names of all nodes."""

    endpoints: tuple[SeenEndpoint, ...]
    nodes: tuple[str, ...]
    kind: Literal["seen"] = "seen"


ToCarrier = (
    Introduce | Beat | Publish | ClearLatched | Subscribe | OfferService | CallService | Look
)
FromCarrier = (
    Beat | NewSubscriber | Subscribers | PublisherFound | PublisherLost | ServiceState | Seen
)
_ANY: TypeAdapter[Any] = TypeAdapter(Union[ToCarrier, FromCarrier])  # noqa: UP007 - of two unions
TO_CARRIER: TypeAdapter[ToCarrier] = TypeAdapter(Annotated[ToCarrier, Field(discriminator="kind")])
FROM_CARRIER: TypeAdapter[FromCarrier] = TypeAdapter(
    Annotated[FromCarrier, Field(discriminator="kind")]
)


def encode(message: ToCarrier | FromCarrier) -> bytes:
    """Return a message as JSON."""
    return _ANY.dump_json(message)


def decode(adapter: TypeAdapter[Any], data: bytes) -> Any:  # noqa: ANN401 - what the adapter reads
    """Return a message that an adapter reads; WireError if it is none."""
    try:
        return adapter.validate_json(data, strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        raise WireError(f"it is no message of a cell: {first['msg']}") from None
