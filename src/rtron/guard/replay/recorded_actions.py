"""An action of ROS 2 in a recording: its requests as service introspection told them, its status.

Nobody is asked anything: the server answers a goal as it did when it was recorded.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from rtron.errors import InputError, WireError
from rtron.guard.action.ros2.endpoints import CancelReply, GoalReply
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import MessageHandler, Peer, TypeInfo
from rtron.messages.common.definition import Definition
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.messages.common.encoding import Encoding
from rtron.messages.ros2.actions import GoalMessage, read_statuses
from rtron.messages.ros2.service_events import (
    ServiceEvent,
    message_extractor,
    read_answer,
    read_cancel,
    read_event,
    read_goal,
)
from rtron.vocabulary import (
    UNAPPROVED,
    Ros2ActionEntity,
    Stream,
    flow_topic,
    output_topic,
    ros2_entity_name,
)

if TYPE_CHECKING:
    from rtron.guard.action.ros2.stream import Ros2ActionStream

EVENTS = "_service_event"
"""What service introspection adds to a service's name (ROS 2: rcl/service_introspection.h)."""
_MAX_CACHED = 10_000

K = TypeVar("K")
V = TypeVar("V")


class RecordedActionTransport(MemoryTransport):
    """A transport in memory for recordings; its actions are those of the recording."""

    def __init__(self, encoding: Encoding, definitions: DefinitionRegistry) -> None:
        super().__init__(encoding)
        self._definitions = definitions
        self.actions: list[RecordedAction] = []

    def action_endpoints(
        self, stream: Stream, node: str, listener: "Ros2ActionStream"
    ) -> "RecordedAction":
        """Return the endpoints of an action."""
        del node
        goal = self._goal(stream.type)
        self.actions.append(RecordedAction(stream, goal, listener, self))
        return self.actions[-1]

    def _goal(self, type: str) -> Definition | None:
        try:
            return self._definitions.find(type)
        except InputError:
            return None


class RecordedAction:
    """Hands to `listener` what is recorded of an action; see `ActionEndpoints`."""

    def __init__(
        self,
        stream: Stream,
        goal: Definition | None,
        listener: "Ros2ActionStream",
        transport: MemoryTransport,
    ) -> None:
        self.stream = stream
        self.type_info = TypeInfo(goal.type if goal else stream.type, goal.md5sum if goal else "")
        self._copy = message_extractor(goal) if goal else _unread_goal
        self._listener = listener
        self._transport = transport
        self._goal_of_request: dict[tuple[bytes, int], bytes] = {}
        self._goals: dict[bytes, None] = {}
        self._pending_replies: dict[bytes, GoalReply] = {}
        self._answers: dict[bytes, int | None] = {}
        self._last_status: bytes | None = None
        self._listed_stamps: dict[bytes, int] = {}
        self._requests_without_content = self._unreadable_messages = 0
        self._is_client_unknown = False
        self._assumed_client = self._assume_client()

    def receivers(self) -> Iterator[tuple[str, MessageHandler]]:
        """Yield the topics of a recording that tell of the action, and what takes them."""
        action = self.stream.action
        for flow in self.stream.flows:
            peer = Peer(flow.publisher, self.type_info)
            yield from self._receivers_of(flow_topic(action, flow.name), flow.name, peer)
        for name in (action, output_topic(action)):
            yield from self._receivers_of(name, *self._assumed_client)

    def _receivers_of(
        self, name: str, flow: str, peer: Peer
    ) -> Iterator[tuple[str, MessageHandler]]:
        goal, cancel = (partial(take, flow, peer) for take in (self._goal_event, self._cancel))
        yield (
            f"{ros2_entity_name(name, Ros2ActionEntity.SEND_GOAL)}/{EVENTS}",
            partial(self._event, goal),
        )
        yield (
            f"{ros2_entity_name(name, Ros2ActionEntity.CANCEL_GOAL)}/{EVENTS}",
            partial(self._event, cancel),
        )
        yield f"{ros2_entity_name(name, Ros2ActionEntity.GET_RESULT)}/{EVENTS}", _ignore_reply
        yield ros2_entity_name(name, Ros2ActionEntity.STATUS), self._status
        yield ros2_entity_name(name, Ros2ActionEntity.FEEDBACK), _ignore_reply

    def notes(self) -> Iterator[str]:
        """Yield what could not be judged, and why."""
        name = self.stream.action
        if not self._goals and not self._requests_without_content:
            topic = f"{ros2_entity_name(name, Ros2ActionEntity.SEND_GOAL)}/{EVENTS}"
            yield (
                f"{name}: no goals are recorded, they are requests: record {topic}, which a server"
                " or client with service introspection publishes; goals that only the status"
                " tells of count as the server's own"
            )
        if self._is_client_unknown:
            assumed = self._assumed_client[1].node
            assumption = f"taken for {assumed}" if assumed else "nobody that the plan knows"
            yield f"{name}: whose its goals are is not recorded: {assumption}"
        if self._goals and self._last_status is None:
            yield f"{name}: no status is recorded: a goal ends only when it is overdue"
        if self._requests_without_content:
            number = self._requests_without_content
            yield f"{name}: {number} requests are recorded without what they ask: not judged"
        if self._unreadable_messages:
            yield f"{name}: {self._unreadable_messages} messages cannot be read: not judged"

    def _assume_client(self) -> tuple[str, Peer]:
        """Return the flow and the client of requests that do not tell whose they are.

        It is the plan's only client; of several, nobody.
        """
        only = self.stream.flows[0] if len(self.stream.flows) == 1 else None
        return (
            (only.name, Peer(only.publisher, self.type_info))
            if only
            else (UNAPPROVED, Peer("", self.type_info))
        )

    # What is recorded

    def _event(self, take: Callable[[ServiceEvent, bytes], None], message: bytes) -> None:
        try:
            event = read_event(message)
            if event.content_offset:
                take(event, message)
            elif event.is_request:
                self._requests_without_content += 1
        except WireError:
            self._unreadable_messages += 1

    def _goal_event(self, flow: str, peer: Peer, event: ServiceEvent, message: bytes) -> None:
        if not event.is_request:
            self._answer(event, read_answer(message, event.content_offset))
            return
        id, at = read_goal(message, event.content_offset)
        _store(self._goal_of_request, (event.client_gid, event.sequence_number), id)
        if id not in self._goals:
            goal = self._copy(message, at)
            _store(self._goals, id, None)
            self._is_client_unknown = self._is_client_unknown or peer is self._assumed_client[1]
            self._listener.on_goal_request(
                flow, peer, partial(GoalMessage.of, id, goal), _ignore_reply
            )

    def _cancel(self, flow: str, peer: Peer, event: ServiceEvent, message: bytes) -> None:
        if event.is_request:
            id, stamp = read_cancel(message, event.content_offset)
            self._listener.on_cancel_request(flow, peer, id, stamp, _ignore_reply)

    def _answer(self, event: ServiceEvent, stamp: int | None) -> None:
        id = self._goal_of_request.get((event.client_gid, event.sequence_number))
        if id is not None:
            self._deliver_answer(id, stamp)

    def _deliver_answer(self, id: bytes, stamp: int | None) -> None:
        on_reply = self._pending_replies.pop(id, None)
        if on_reply:
            on_reply(stamp)
        else:
            _store(self._answers, id, stamp)

    def _status(self, message: bytes) -> None:
        try:
            statuses = read_statuses(message)
        except WireError:
            self._unreadable_messages += 1
            return
        self._last_status = message
        self._listed_stamps = {each.id: each.stamp for each in statuses}
        for id in sorted(self._listed_stamps.keys() & self._pending_replies.keys()):
            self._deliver_answer(id, self._listed_stamps[id])
        self._listener.on_server_message(Ros2ActionEntity.STATUS, message)

    # What the guard does

    def open(self) -> None:
        """Be there: the server is, although its status may not be recorded."""
        for server in self.stream.successors[:1]:
            self._listener.on_server_available(server, b"recorded")

    def send_goal(self, goal: GoalMessage, on_reply: GoalReply) -> None:
        """Answer as the server did, once it did."""
        self._pending_replies[goal.id] = on_reply
        self._transport.call_at(self._transport.now(), partial(self._answer_sent, goal.id))

    def _answer_sent(self, id: bytes) -> None:
        if id in self._answers:
            self._deliver_answer(id, self._answers.pop(id))
        elif id in self._listed_stamps:
            self._deliver_answer(id, self._listed_stamps[id])
        if self._last_status is not None:
            self._listener.on_server_message(Ros2ActionEntity.STATUS, self._last_status)

    def cancel(self, id: bytes, stamp: int, on_reply: CancelReply) -> None:
        """Ask nobody: the recorded status tells what became of the goal."""

    def get_result(self, id: bytes, on_reply: Callable[[int, object], None]) -> None:
        """Ask nobody."""

    def publish(
        self, end: Ros2ActionEntity, message: bytes, flows: Sequence[str] | None = None
    ) -> None:
        """Tell nobody."""

    def restore_reply(self, token: str) -> None:
        """Know of no requests to a guard before."""
        del token


def _store(cache: dict[K, V], key: K, value: V) -> None:
    """Keep a value; the oldest makes room."""
    if len(cache) >= _MAX_CACHED:
        del cache[next(iter(cache))]
    cache[key] = value


def _unread_goal(message: bytes, at: int) -> bytes:
    """Return a goal whose type is not known: nobody looks into it."""
    return message[:4] + message[at:]


def _ignore_reply(*_answer: object) -> None:
    """Hear no answer."""
