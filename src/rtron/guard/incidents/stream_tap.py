"""One stream, tapped: each message, what was decided, and who is in command.

A message costs its process two tuples: nothing is encoded, written or waited for on its way.
"""

from typing import TYPE_CHECKING

from rtron.guard.incidents.entries import (
    LONGEST_MESSAGE,
    ControlState,
    EntryBuffer,
    LearnedType,
    Received,
    Sent,
)
from rtron.vocabulary import SECOND, Decision, Verdict

if TYPE_CHECKING:
    from rtron.guard.core.stream import GuardedStream


def is_due(noted_at: int, now: int) -> bool:
    """Tell whether what has not changed is to be noted again: an incident begins anywhere."""
    return now - noted_at >= SECOND


class StreamTap:
    """Notes each message of a stream, what was decided, and who is in command."""

    def __init__(self, guarded: "GuardedStream", buffer: EntryBuffer) -> None:
        self._guarded = guarded
        self._topic = guarded.spec.topic
        self._buffer = buffer
        self._state: ControlState | None = None
        self._is_type_noted = False

    def note_received(self, flow: str, message: bytes, now: int, verdict: Verdict | None) -> None:
        """Note a message and its verdict; None after an internal error."""
        size = len(message)
        content = message if type(message) is bytes and size <= LONGEST_MESSAGE else b""
        owner = self._guarded.pipeline.owner or ""
        if verdict is None:
            what = (Decision.DROP, "", "internal error", 0)
        else:
            what = (verdict.decision, verdict.policy, verdict.reason, verdict.revision)
        self._buffer.add(
            Received(now, self._topic, flow, content, size, owner, *what), len(content)
        )

    def note_sent(self, flow: str, message: bytes, now: int) -> None:
        """Note a message that goes out."""
        size = len(message)
        content = message if type(message) is bytes and size <= LONGEST_MESSAGE else b""
        stopping = self._guarded.stop_controller.reason
        self._buffer.add(Sent(now, self._topic, flow, content, size, stopping), len(content))

    def sample(self, now: int) -> None:
        """Note who is in command and the limit, if that has changed or a second is over."""
        guarded, owner = self._guarded, self._guarded.pipeline.owner or ""
        publishers = {flow.name: flow.publisher for flow in guarded.spec.flows}
        state = ControlState(
            at=now,
            topic=self._topic,
            owner=owner,
            publisher=publishers.get(owner, ""),
            stopping=guarded.stop_controller.reason or guarded.brake_reason,
            limit=guarded.limit(now),
            speed=guarded.stop_controller.speed,
        )
        if self._state is None or state[1:] != self._state[1:] or is_due(self._state.at, now):
            self._state = state
            self._buffer.add(state)

    def new_type(self) -> LearnedType | None:
        """Return what the stream's messages are, once."""
        info = self._guarded.endpoints.type_info
        if info is None or self._is_type_noted:
            return None
        self._is_type_noted = True
        publishers = tuple((flow.name, flow.publisher) for flow in self._guarded.spec.flows)
        return LearnedType(self._topic, info.type, info.md5sum, info.definition, publishers)

    def forget(self) -> None:
        """Note type and state once more: nobody knows them."""
        self._is_type_noted, self._state = False, None
