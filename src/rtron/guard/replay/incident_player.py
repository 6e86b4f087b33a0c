"""What would have been: an incident's messages played through the policies of another plan.

The policies are those of the running guard, and the recording moves their clock. What they depend
on beside the messages, frame rates and events, stands on a board as in the command process, and
changes when it changed. What an alarm, the emergency stop or a person did is not played.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from rtron.guard.coordinator import Coordinator
from rtron.guard.incidents.entries import Observed
from rtron.guard.lanes.command.board_observations import BoardObservations
from rtron.guard.lanes.exchange.board import REFRESH_PERIOD, Board, EventRecord, RateRecord
from rtron.guard.replay.recorded_actions import RecordedActionTransport
from rtron.guard.replay.recorded_streams import RecordedStream, RecordedStreams
from rtron.guard.transport.common.protocol import MessageHandler, TypeInfo
from rtron.messages.common.encoding import Encoding
from rtron.policies.mission.event_bits import EventState
from rtron.vocabulary import Plan

Output: TypeAlias = list[tuple[int, bytes]]
"""What went out, and when (ns)."""


@dataclass(frozen=True, slots=True)
class PlayedMessage:
    """A recorded message at a time (ns), and who said it where."""

    at: int
    stream: RecordedStream
    data: bytes


class IncidentPlayer:
    """Plays messages and observations in the order of their times; `outputs` are by topic."""

    def __init__(self, plan: Plan, begin: int) -> None:
        """Begin at a time (ns) with nothing heard."""
        self.outputs: dict[str, Output] = {}
        self.notes: list[str] = []
        self._places = RecordedStreams.from_plan(plan)
        encoding = Encoding.ROS1 if plan.ros == 1 else Encoding.CDR
        self._transport = RecordedActionTransport(encoding, self._places.definitions)
        self._transport.jump(begin)
        self._observations = BoardObservations(plan)
        observations = self._observations.observations
        self._coordinator = Coordinator(self._transport, self._places.streams, observations)
        self._rates = list(observations.rates.monitors)
        self._events = [flow.name for flow in plan.msrcn.eflows] if plan.msrcn else []
        self._board = Board.create(len(self._rates), len(self._events))
        self._observed = Observed(begin, (), ())
        self._receivers: dict[RecordedStream, MessageHandler] = {}
        self._open(begin)

    def play(self, recording: Iterable[PlayedMessage | Observed], end: int) -> None:
        """Play a recording, and let time pass until `end` (ns)."""
        for each in recording:
            self._pass_time(each.at)
            if isinstance(each, Observed):
                self._observed = each
                self._refresh()
            else:
                receive = self._receivers.get(each.stream) or self._connect(each.stream)
                receive(each.data)
        self._pass_time(end)

    def close(self) -> None:
        """Let go of the board."""
        self._observations.connect(None, self._transport.now())

    def _open(self, begin: int) -> None:
        self._observations.connect(self._board, begin)
        for stream in self._coordinator.streams:
            output = self.outputs.setdefault(stream.spec.topic, [])
            stream.set_listeners(_ignore_type, partial(self._note_output, output))
        self._coordinator.open_streams()
        self._refresh_periodically()

    def _note_output(self, output: Output, _flow: str, message: bytes) -> None:
        output.append((self._transport.now(), message))

    def _pass_time(self, until: int) -> None:
        ahead = until - self._transport.now()
        if ahead > 0:
            self._transport.advance(ahead)

    def _refresh_periodically(self) -> None:
        now = self._transport.now()
        self._transport.call_at(now + REFRESH_PERIOD, self._refresh_periodically)
        self._refresh()

    def _refresh(self) -> None:
        """Write what was observed last to the board, as a bulk process does."""
        now, observed = self._transport.now(), self._observed
        rates = {each[0]: each[1:] for each in observed.rates}
        for index, id in enumerate(self._rates):
            if id in rates:
                fps, last_frame_at = rates[id]
                self._board.write_rate(index, RateRecord(fps, last_frame_at, now))
        events = {each[0]: EventState(*each[1:]) for each in observed.events}
        for index, name in enumerate(self._events):
            if name in events:
                self._board.write_event(index, EventRecord(events[name], now))
        self._observations.update(now)
        self._coordinator.schedule_deadline()

    def _connect(self, stream: RecordedStream) -> MessageHandler:
        topic, peer = self._places.topic(stream), self._places.peer(stream)
        if topic == stream.topic:
            self.notes.append(f"{stream.topic}: {peer.node} is not approved in this plan")
        receive = self._transport.publisher(topic, peer) if topic else _ignore_message
        self._receivers[stream] = receive
        return receive


def _ignore_type(_info: TypeInfo) -> None:
    """Take the type of an output for what it is."""


def _ignore_message(_message: bytes) -> None:
    """Play nothing."""
