"""What a session decides: frames to send, and what its node does in the ROS graph.

The protocol's core does nothing itself: who runs it carries these out, in their order.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Any, TypeAlias


@dataclass(frozen=True, slots=True)
class SendAnswer:
    """A frame that the client is to get."""

    text: str


@dataclass(frozen=True, slots=True)
class SendMessage:
    """A message of a topic, in one frame or in fragments; dropped if the client reads slowly.

    Bytes are a binary frame.
    """

    frames: tuple["str | bytes", ...]


@dataclass(frozen=True, slots=True)
class AdvertiseTopic:
    """Publish a topic of the graph from now on; `listeners` are the guard's nodes that hear it."""

    topic: str
    type: str
    listeners: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class WithdrawTopic:
    """Publish a topic of the graph no more."""

    topic: str


@dataclass(frozen=True, slots=True)
class PublishBytes:
    """Publish a message on a topic that was advertised; `is_latched` keeps it for late ones."""

    topic: str
    message: bytes
    is_latched: bool = False


@dataclass(frozen=True, slots=True)
class ReadTopic:
    """Subscribe to a topic of the graph from now on."""

    topic: str
    type: str


@dataclass(frozen=True, slots=True)
class LeaveTopic:
    """Subscribe to a topic of the graph no more."""

    topic: str


@dataclass(frozen=True, slots=True)
class RequestService:
    """Call a service with a request; its answer is given back under the number."""

    number: int
    service: str
    type: str
    request: bytes


class ParameterVerb(str, Enum):
    """What is done with a parameter."""

    GET = "get_param"
    SET = "set_param"
    HAS = "has_param"
    DELETE = "delete_param"


@dataclass(frozen=True, slots=True)
class RequestParameter:
    """Read or write a parameter; the answer is given back under the number."""

    number: int
    verb: ParameterVerb
    name: str
    value: Any = None


@dataclass(frozen=True, slots=True)
class SendGoal:
    """Send a goal to an action of the graph; what becomes of it is told under the number."""

    number: int
    action: str
    type: str
    goal: bytes


@dataclass(frozen=True, slots=True)
class CancelGoal:
    """Ask for the cancel of a goal."""

    number: int


@dataclass(frozen=True, slots=True)
class CloseSession:
    """End the connection: the client does not keep to its limits."""

    reason: str


Effect: TypeAlias = (
    SendAnswer
    | SendMessage
    | AdvertiseTopic
    | WithdrawTopic
    | PublishBytes
    | ReadTopic
    | LeaveTopic
    | RequestService
    | RequestParameter
    | SendGoal
    | CancelGoal
    | CloseSession
)
