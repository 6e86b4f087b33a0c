"""What the guard needs of a middleware for an action of ROS 2: requests, answers, and two topics.

Ids are the 16 bytes of a goal's UUID, stamps ns of the wall clock, states those of
action_msgs/GoalStatus; goals are CDR, results whatever the middleware hands over, unchanged.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages.ros2.actions import GoalMessage
from rtron.vocabulary import Ros2ActionEntity, Stream

MAX_PENDING_RESULTS = 8
"""So many requests for one goal's result wait for it."""


DecodeGoal = Callable[[], GoalMessage]
"""Reads a goal that was sent; WireError if it is none."""
GoalReply = Callable[[int | None], None]
"""Takes since when a goal is accepted, None if it is rejected."""


@dataclass(frozen=True, slots=True)
class CancelResponse:
    """The answer to a cancel: a code of action_msgs/CancelGoal, and the goals that will end."""

    code: int
    goals: Sequence[tuple[bytes, int]] = ()


NONE, REJECTED, UNKNOWN_GOAL, TERMINATED = range(4)
"""The codes."""
CancelReply = Callable[[CancelResponse], None]


class ResultReply(Protocol):
    """The place of a request for a result; a later guard answers there by its `token`."""

    token: str

    @property
    def is_reachable(self) -> bool:
        """Whether the client has had the time to find this guard: before, an answer may be lost."""
        ...

    def __call__(self, status: int, result: object | None) -> None:
        """Answer; without a result, with an empty one."""
        ...


class ServerListener(Protocol):
    """Who is told what the server says, and whether it is there."""

    def on_server_message(self, end: Ros2ActionEntity, message: bytes) -> None:
        """Take a feedback message or a status array of the server, as CDR."""
        ...

    def on_server_available(self, node: str, incarnation: bytes) -> None:
        """Learn that the server is there and answers; `incarnation` is another after a restart."""
        ...

    def on_server_lost(self) -> None:
        """Learn that the server is not there any more."""
        ...

    def on_server_doubt(self, reason: str) -> None:
        """Learn that not only the server may answer, and why; "" when it is alone again."""
        ...


class ActionListener(ServerListener, Protocol):
    """Who is told what clients ask, too."""

    def on_goal_request(self, flow: str, peer: Peer, decode: DecodeGoal, reply: GoalReply) -> None:
        """Take a goal that was sent under the name of a flow; a stranger's need not be read."""
        ...

    def on_result_request(self, flow: str, peer: Peer, id: bytes, reply: ResultReply) -> None:
        """Take a request for a goal's result."""
        ...

    def on_cancel_request(
        self, flow: str, peer: Peer, id: bytes, stamp: int, reply: CancelReply
    ) -> None:
        """Take a cancel; `NO_ID` and 0 mean every goal, a stamp all goals up to then."""
        ...


class ActionEndpoints(Protocol):
    """The services and topics of one action: towards its clients, and towards its server."""

    type_info: TypeInfo
    """What goals look like."""

    def open(self) -> None:
        """Join the graph."""
        ...

    def send_goal(self, goal: GoalMessage, on_reply: GoalReply) -> None:
        """Send a goal to the server."""
        ...

    def cancel(self, id: bytes, stamp: int, on_reply: CancelReply) -> None:
        """Send a cancel to the server."""
        ...

    def get_result(self, id: bytes, on_reply: Callable[[int, object], None]) -> None:
        """Ask the server for a result; the answer comes when the goal is over."""
        ...

    def publish(
        self, end: Ros2ActionEntity, message: bytes, flows: Sequence[str] | None = None
    ) -> None:
        """Tell the clients of some flows, or all, and whoever listens under the public name."""
        ...

    def restore_reply(self, token: str) -> ResultReply | None:
        """Return the place of a request that came to the guard before; None if it is none."""
        ...


@runtime_checkable
class ActionTransport(Protocol):
    """A transport on which an action of ROS 2 can be guarded."""

    def action_endpoints(
        self, stream: Stream, node: str, listener: ActionListener
    ) -> ActionEndpoints:
        """Return the ends of a stream's action, of one of the guard's nodes; not open yet."""
        ...
