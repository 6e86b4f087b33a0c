"""An action of ROS 2 in a recording: its requests as service introspection told them, its status.

Nobody is asked anything: the server answers a goal as it did when it was recorded.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TypeVar

from rtron.errors import InputError, WireError
from rtron.guard.action.ros2.endpoints import AnswerCancel, AnswerGoal, GoalMessage, Hears
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer, Receive, TypeInfo
from rtron.messages.common.definition import Definition
from rtron.messages.common.definition_registry import Definitions
from rtron.messages.common.encoding import Encoding
from rtron.messages.ros2.actions import read_statuses
from rtron.messages.ros2.service_events import (
    ServiceEvent,
    moved,
    read_answer,
    read_cancel,
    read_event,
    read_goal,
)
from rtron.vocabulary import (
    UNAPPROVED,
    ActionEnd,
    Stream,
    end_name,
    flow_topic,
    output_topic,
)

EVENTS = "_service_event"
"""What service introspection adds to a service's name (ROS 2: rcl/service_introspection.h)."""
_MOST_KEPT = 10_000

K = TypeVar("K")
V = TypeVar("V")


class RecordedRequests(MemoryTransport):
    """A transport in memory for recordings; its actions are those of the recording."""

    def __init__(self, encoding: Encoding, definitions: Definitions) -> None:
        super().__init__(encoding)
        self._definitions = definitions
        self.actions: list[RecordedAction] = []

    def action_ends(self, stream: Stream, node: str, hears: Hears) -> "RecordedAction":
        """Return the ends of an action; see `CarriesRequests`."""
        del node
        goal = self._goal(stream.type)
        self.actions.append(RecordedAction(stream, goal, hears, self))
        return self.actions[-1]

    def _goal(self, type: str) -> Definition | None:
        try:
            return self._definitions.find(type)
        except InputError:
            return None


class RecordedAction:
    """Hands to `hears` what is recorded of an action; see `Ends`."""

    def __init__(
        self, stream: Stream, goal: Definition | None, hears: Hears, transport: MemoryTransport
    ) -> None:
        self.stream = stream
        self.info = TypeInfo(goal.type if goal else stream.type, goal.md5sum if goal else "")
        self._copy = moved(goal) if goal else _as_it_is
        self._hears = hears
        self._transport = transport
        self._asked: dict[tuple[bytes, int], bytes] = {}
        self._goals: dict[bytes, None] = {}
        self._unanswered: dict[bytes, AnswerGoal] = {}
        self._answers: dict[bytes, int | None] = {}
        self._last_status: bytes | None = None
        self._listed: dict[bytes, int] = {}
        self._empty = self._unreadable = 0
        self._nameless = False
        self._whose = self._taken_for()

    def receivers(self) -> Iterator[tuple[str, Receive]]:
        """Yield the topics of a recording that tell of the action, and what takes them."""
        action = self.stream.action
        for flow in self.stream.flows:
            peer = Peer(flow.publisher, self.info)
            yield from self._of(flow_topic(action, flow.name), flow.name, peer)
        for name in (action, output_topic(action)):
            yield from self._of(name, *self._whose)

    def _of(self, name: str, flow: str, peer: Peer) -> Iterator[tuple[str, Receive]]:
        goal, cancel = (partial(take, flow, peer) for take in (self._goal_event, self._cancel))
        yield f"{end_name(name, ActionEnd.SEND_GOAL)}/{EVENTS}", partial(self._event, goal)
        yield f"{end_name(name, ActionEnd.CANCEL_GOAL)}/{EVENTS}", partial(self._event, cancel)
        yield f"{end_name(name, ActionEnd.GET_RESULT)}/{EVENTS}", _ignore
        yield end_name(name, ActionEnd.STATUS), self._status
        yield end_name(name, ActionEnd.FEEDBACK), _ignore

    def notes(self) -> Iterator[str]:
        """Yield what could not be judged, and why."""
        name = self.stream.action
        if not self._goals and not self._empty:
            topic = f"{end_name(name, ActionEnd.SEND_GOAL)}/{EVENTS}"
            yield (
                f"{name}: no goals are recorded, they are requests: record {topic}, which a server"
                " or client with service introspection publishes; goals that only the status"
                " tells of count as the server's own"
            )
        if self._nameless:
            taken = self._whose[1].node
            whose = f"taken for {taken}" if taken else "nobody that the plan knows"
            yield f"{name}: whose its goals are is not recorded: {whose}"
        if self._goals and self._last_status is None:
            yield f"{name}: no status is recorded: a goal ends only when it is overdue"
        if self._empty:
            yield f"{name}: {self._empty} requests are recorded without what they ask: not judged"
        if self._unreadable:
            yield f"{name}: {self._unreadable} messages cannot be read: not judged"

    def _taken_for(self) -> tuple[str, Peer]:
        """Return the flow and the client of requests that do not tell whose they are.

        It is the plan's only client; of several, nobody.
        """
        only = self.stream.flows[0] if len(self.stream.flows) == 1 else None
        return (
            (only.name, Peer(only.publisher, self.info))
            if only
            else (UNAPPROVED, Peer("", self.info))
        )

    # What is recorded

    def _event(self, take: Callable[[ServiceEvent, bytes], None], message: bytes) -> None:
        try:
            event = read_event(message)
            if event.at:
                take(event, message)
            elif event.asks:
                self._empty += 1
        except WireError:
            self._unreadable += 1

    def _goal_event(self, flow: str, peer: Peer, event: ServiceEvent, message: bytes) -> None:
        if not event.asks:
            self._answer(event, read_answer(message, event.at))
            return
        id, at = read_goal(message, event.at)
        _keep(self._asked, (event.asker, event.number), id)
        if id not in self._goals:
            goal = self._copy(message, at)
            _keep(self._goals, id, None)
            self._nameless = self._nameless or peer is self._whose[1]
            self._hears.goal_asked(flow, peer, partial(GoalMessage.of, id, goal), _ignore)

    def _cancel(self, flow: str, peer: Peer, event: ServiceEvent, message: bytes) -> None:
        if event.asks:
            id, stamp = read_cancel(message, event.at)
            self._hears.cancel_asked(flow, peer, id, stamp, _ignore)

    def _answer(self, event: ServiceEvent, stamp: int | None) -> None:
        id = self._asked.get((event.asker, event.number))
        if id is not None:
            self._answered(id, stamp)

    def _answered(self, id: bytes, stamp: int | None) -> None:
        answered = self._unanswered.pop(id, None)
        if answered:
            answered(stamp)
        else:
            _keep(self._answers, id, stamp)

    def _status(self, message: bytes) -> None:
        try:
            listed = read_statuses(message)
        except WireError:
            self._unreadable += 1
            return
        self._last_status = message
        self._listed = {each.id: each.stamp for each in listed}
        for id in sorted(self._listed.keys() & self._unanswered.keys()):
            self._answered(id, self._listed[id])
        self._hears.server_told(ActionEnd.STATUS, message)

    # What the guard does

    def open(self) -> None:
        """Be there: the server is, although its status may not be recorded."""
        for server in self.stream.successors[:1]:
            self._hears.server_came(server, b"recorded")

    def send_goal(self, goal: GoalMessage, answered: AnswerGoal) -> None:
        """Answer as the server did, once it did."""
        self._unanswered[goal.id] = answered
        self._transport.call_at(self._transport.now(), partial(self._answer_sent, goal.id))

    def _answer_sent(self, id: bytes) -> None:
        if id in self._answers:
            self._answered(id, self._answers.pop(id))
        elif id in self._listed:
            self._answered(id, self._listed[id])
        if self._last_status is not None:
            self._hears.server_told(ActionEnd.STATUS, self._last_status)

    def cancel(self, id: bytes, stamp: int, answered: AnswerCancel) -> None:
        """Ask nobody: the recorded status tells what became of the goal."""

    def get_result(self, id: bytes, answered: Callable[[int, object], None]) -> None:
        """Ask nobody."""

    def tell(self, end: ActionEnd, message: bytes, flows: Sequence[str] | None = None) -> None:
        """Tell nobody."""

    def place(self, token: str) -> None:
        """Know of no requests to a guard before."""
        del token


def _keep(kept: dict[K, V], key: K, value: V) -> None:
    """Keep a value; the oldest makes room."""
    if len(kept) >= _MOST_KEPT:
        del kept[next(iter(kept))]
    kept[key] = value


def _as_it_is(message: bytes, at: int) -> bytes:
    """Return a goal whose type is not known: nobody looks into it."""
    return message[:4] + message[at:]


def _ignore(*_answer: object) -> None:
    """Hear no answer."""
