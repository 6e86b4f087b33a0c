"""A client's session in rosbridge v2: frames in, decisions out, without I/O and clock.

Everything that a client may not do, and every frame that is none, is refused with a status message
of level `error`; nothing is dropped without a word.
"""

from collections.abc import Callable

from rtron.bridge.common.plan_topics import PlanTopics
from rtron.bridge.protocol.action_operations import ActionOperations
from rtron.bridge.protocol.approvals import Approvals
from rtron.bridge.protocol.client_state import (
    ClientRates,
    ClientState,
    KnownTypes,
    StatusLevel,
    TokenBucket,
)
from rtron.bridge.protocol.effects import CloseSession, Effect
from rtron.bridge.protocol.frames import (
    Document,
    FragmentAssembler,
    decode_frame,
    frame_id,
    size_of,
)
from rtron.bridge.protocol.service_operations import ServiceOperations
from rtron.bridge.protocol.topic_operations import TopicOperations
from rtron.bridge.rights.document import ClientRights
from rtron.errors import RTronError, WireError

_REFUSED = {
    "png": "a picture may unpack to any size",
    "advertise_service": "clients offer no services here",
    "unadvertise_service": "clients offer no services here",
    "service_response": "clients offer no services here",
    "advertise_action": "clients offer no actions here",
    "unadvertise_action": "clients offer no actions here",
    "action_feedback": "clients offer no actions here",
    "action_result": "clients offer no actions here",
    "auth": "you are signed in",
}
"""What the protocol has and this bridge does not do, and why."""

_PATIENCE = 5.0
"""For so many seconds a client may send twice what it may, before its connection ends."""

_Operation = Callable[[Document, int, int], None]


class ClientSession:
    """One client that has signed in. Times are ns: `now` steady, `wall_time` since 1970."""

    def __init__(
        self,
        client: ClientRights,
        topics: PlanTopics,
        types: KnownTypes,
        ros: int,
        rates: ClientRates,
        approvals: Approvals,
    ) -> None:
        """`rates` are those of the client's sessions before, `approvals` those of all clients."""
        self._state = ClientState(client, topics, types, ros, rates, approvals)
        self._topics = TopicOperations(self._state)
        self._services = ServiceOperations(self._state)
        self._actions = ActionOperations(self._state)
        limits = client.limits
        frames = TokenBucket(limits.frames, max(1.0, limits.frames / 2))
        self._frames = rates.keep("frames", frames)
        size = TokenBucket(limits.bytes, limits.bytes + limits.message)
        self._bytes = rates.keep("bytes", size)
        excess = TokenBucket(limits.frames, limits.frames * _PATIENCE)
        self._excess = rates.keep("excess", excess)
        self._fragments = FragmentAssembler(limits.message)
        self._operations: dict[str, _Operation] = {
            "advertise": self._topics.advertise,
            "unadvertise": self._topics.unadvertise,
            "publish": self._topics.publish,
            "subscribe": self._topics.subscribe,
            "unsubscribe": self._topics.unsubscribe,
            "call_service": self._services.call_service,
            "send_action_goal": self._actions.send_goal,
            "cancel_action_goal": self._actions.cancel_goal,
            "set_level": self._set_level,
            "status": self._set_nothing,
            "fragment": self._assemble,
        }

    @property
    def client(self) -> ClientRights:
        """Whose session this is."""
        return self._state.client

    @property
    def refused(self) -> int:
        """How many operations were refused so far."""
        return self._state.refused

    def receive(self, text: str, now: int, wall_time: int) -> list[Effect]:
        """Take a frame; return what is to be done."""
        if self._is_within_limits(size_of(text), now):
            self._handle(text, now, wall_time)
        return self._take_effects()

    def note_control(self, now: int) -> list[Effect]:
        """Count a ping or a pong, which takes time like any frame; return what is to be done."""
        self._is_within_limits(0, now)
        return self._take_effects()

    def deliver(self, topic: str, message: bytes, now: int) -> list[Effect]:
        """Take a message of a topic of the graph; return what is to be sent."""
        try:
            self._topics.deliver(topic, message, now)
        except RTronError as error:
            self._state.refuse(f"{topic}: {error}", now)
        return self._take_effects()

    def finish_call(self, number: int, answer: "bytes | Document | RTronError") -> list[Effect]:
        """Take the answer to a call; return what is to be sent."""
        self._services.finish(number, answer)
        return self._take_effects()

    def deliver_feedback(self, number: int, feedback: bytes, now: int) -> list[Effect]:
        """Take the feedback of a goal; return what is to be sent."""
        try:
            self._actions.deliver_feedback(number, feedback, now)
        except RTronError as error:
            self._state.refuse(f"feedback: {error}", now)
        return self._take_effects()

    def finish_goal(self, number: int, result: "bytes | RTronError") -> list[Effect]:
        """Take the result of a goal, or why it has none; return what is to be sent."""
        self._actions.finish(number, result)
        return self._take_effects()

    def tell(self, reason: str, now: int) -> list[Effect]:
        """Take what went wrong in the graph; return what is to be sent."""
        self._state.refuse(reason, now)
        return self._take_effects()

    def warn(self, reason: str) -> list[Effect]:
        """Take what the client should know even if it asked for errors only; return the frames."""
        if self._state.level != "none":
            self._state.send({"op": "status", "level": "warning", "msg": reason})
        return self._take_effects()

    def tick(self, now: int) -> list[Effect]:
        """Do what time has brought: messages that waited, and calls that nobody answered."""
        try:
            self._topics.send_due(now)
        except RTronError as error:
            self._state.refuse(str(error), now)
        self._services.end_late(now)
        return self._take_effects()

    @property
    def next_tick(self) -> int | None:
        """When `tick` has something to do, ns."""
        times = (self._topics.next_at, self._services.next_at)
        return min((each for each in times if each is not None), default=None)

    def _is_within_limits(self, size: int, now: int) -> bool:
        """Count a frame; refuse it if there are too many, and at last the client, too."""
        if self._frames.take(now) and self._bytes.take(now, size):
            return True
        limits = self._state.client.limits
        reason = f"more than {limits.frames:g} frames or {limits.bytes} bytes a second"
        self._state.refuse(reason, now)
        if not self._excess.take(now):
            self._state.effects.append(CloseSession(reason))
        return False

    def _handle(self, text: str, now: int, wall_time: int) -> None:
        id: object = None
        try:
            document = self._decode(text)
            id = frame_id(document)
            self._find_operation(document["op"])(document, now, wall_time)
        except RTronError as error:
            self._state.refuse(str(error), now, id)

    def _decode(self, text: str) -> Document:
        limit = self._state.client.limits.message
        if (size := size_of(text)) > limit:
            raise WireError(f"the frame has {size} bytes, you send at most {limit}")
        return decode_frame(text)

    def _find_operation(self, op: str) -> _Operation:
        operation = self._operations.get(op)
        if operation:
            return operation
        if op in _REFUSED:
            raise WireError(f"{op} is refused: {_REFUSED[op]}")
        raise WireError(f"there is no operation {op[:40]!r}")

    def _assemble(self, document: Document, now: int, wall_time: int) -> None:
        text = self._fragments.add(document, now)
        if text is None:
            return
        whole = self._decode(text)
        if whole["op"] == "fragment":
            raise WireError("a fragment of fragments")
        self._find_operation(whole["op"])(whole, now, wall_time)

    def _set_level(self, document: Document, now: int, wall_time: int) -> None:
        del now, wall_time
        level = document.get("level")
        if level not in StatusLevel.ORDER:
            raise WireError(f"the level is one of {', '.join(StatusLevel.ORDER)}")
        self._state.level = str(level)

    def _set_nothing(self, document: Document, now: int, wall_time: int) -> None:
        """Take a status message of the client, which asks for nothing."""

    def _take_effects(self) -> list[Effect]:
        effects, self._state.effects = self._state.effects, []
        return effects
