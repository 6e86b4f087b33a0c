"""A recording played through the same pipelines as a running app, with the recording's clock."""

from collections.abc import Callable, Iterable, Iterator
from functools import partial

from rtron.guard.action.ros1.stream import Ros1ActionStream
from rtron.guard.action.ros1.topics import STATUS
from rtron.guard.action.ros2.stream import ObservedActionStream
from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.authority.lease_topics import LeaseTopics
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import observations_of
from rtron.guard.core.stream import GuardedStream
from rtron.guard.measurement.run import RunMeasurement
from rtron.guard.replay.recorded_actions import RecordedActionTransport
from rtron.guard.replay.recorded_streams import RecordedStream, RecordedStreams
from rtron.guard.transport.common.protocol import MessageHandler, Peer
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    SECOND,
    SERVER_FLOW,
    DecisionChange,
    MeasuredRun,
    Plan,
    ReplayFlowCounts,
    ReplayReport,
    ReplayStreamCounts,
    Ros1ActionTopic,
    Verdict,
    flow_topic,
    ros1_topic_name,
)

MOST_CHANGES = 10_000
LONGEST_GAP = 60 * SECOND
_STEP = 10_000
Message = tuple[int, RecordedStream, bytes]
"""A recorded message: its time (ns), what it belongs to, and its bytes as the guard sees them."""


class RecordingPlayer:
    """Plays messages in the order of their times; what the guard would have said is noted.

    Time that goes back in a recording stands still here. `measured`: figures are kept.
    """

    def __init__(self, plan: Plan, *, measured: bool = False) -> None:
        self._recorded_streams = RecordedStreams.from_plan(plan)
        encoding = Encoding.ROS1 if plan.ros == 1 else Encoding.CDR
        self._transport = RecordedActionTransport(encoding, self._recorded_streams.definitions)
        self._measurement = RunMeasurement(plan, self._transport) if measured else None
        observations = (
            self._measurement.observations if self._measurement else observations_of(plan)
        )
        self._coordinator = Coordinator(
            self._transport, self._recorded_streams.streams, observations
        )
        self._receivers: dict[RecordedStream, MessageHandler] = {}
        self._changes: list[DecisionChange] = []
        self._omitted_changes = 0
        self._notes: list[str] = []
        self._messages = 0
        self._start_time: int | None = None
        if self._measurement:
            self._measurement.measure(self._coordinator.streams)
        self._coordinator.open_streams()
        leases = LeaseController(self._coordinator, self._transport)
        LeaseTopics(leases, self._transport).open()
        receivers = (pair for action in self._transport.actions for pair in action.receivers())
        self._requests: dict[str, MessageHandler] = dict(receivers)
        for stream in self._coordinator.streams:
            self._connect_server(stream)
        for stream in self._coordinator.streams:
            stream.pipeline.on_verdict_change = partial(self._on_verdict_change, stream.spec.topic)
            stream.on_state_change = partial(self._on_stop_change, stream)

    def play(self, messages: Iterable[Message], progress: Callable[[int], None]) -> ReplayReport:
        """Play messages and return what was found so far; `progress` is told how many were read."""
        transport, receivers = self._transport, self._receivers
        for time, recorded, data in messages:
            if self._start_time is None:
                self._start_time = time
            ahead = time - self._start_time - transport.now()
            if ahead > 0:
                self._pass_time(ahead)
            receive = receivers.get(recorded) or self._connect(recorded)
            receive(data)
            self._messages += 1
            if self._messages % _STEP == 0:
                progress(self._messages)
        return self._summary()

    def _connect_server(self, stream: GuardedStream) -> None:
        """Let the server of an action be there, although its status may not be recorded."""
        info = standard_info(STATUS, self._transport.encoding)
        if isinstance(stream, Ros1ActionStream) and info:
            status = ros1_topic_name(stream.name, Ros1ActionTopic.STATUS)
            for server in stream.spec.successors[:1]:
                self._transport.publisher(flow_topic(status, SERVER_FLOW), Peer(server, info))

    def figures(self) -> MeasuredRun:
        """Return what was measured of all that was played."""
        if self._measurement is None:
            raise AssertionError("nothing was measured")
        return self._measurement.figures()

    def _pass_time(self, duration: int) -> None:
        """Let time pass; a long gap is mostly jumped over, since nothing can happen in it."""
        step = min(duration, LONGEST_GAP)
        self._transport.advance(step)
        if duration > step:
            self._notes.append(f"nothing was recorded for {duration / SECOND:.0f} s")
            self._transport.jump(duration - step)

    def _connect(self, recorded: RecordedStream) -> MessageHandler:
        receive = self._requests.get(recorded.topic) or self._publisher(recorded)
        self._receivers[recorded] = receive
        return receive

    def _publisher(self, recorded: RecordedStream) -> MessageHandler:
        topic = self._recorded_streams.topic(recorded)
        if not recorded.publisher:
            self._note_publisher(recorded)
        return (
            self._transport.publisher(topic, self._recorded_streams.peer(recorded))
            if topic
            else _ignore_message
        )

    def _note_publisher(self, recorded: RecordedStream) -> None:
        assumed = self._recorded_streams.publisher(recorded)
        who = f"taken for {assumed}" if assumed else "nobody that the plan knows"
        self._notes.append(f"{recorded.topic}: its publisher is not recorded: {who}")

    def _on_verdict_change(self, topic: str, verdict: Verdict) -> None:
        self._add(topic, verdict.flow, verdict.decision, verdict.policy, verdict.reason)

    def _on_stop_change(self, stream: GuardedStream) -> None:
        if stream.stop_controller.reason:
            stopped = stream.stop_controller.last_flow
            self._add(stream.spec.topic, stopped, "stop", "", stream.stop_controller.reason)

    def _add(self, topic: str, flow: str, decision: str, policy: str, reason: str) -> None:
        if len(self._changes) >= MOST_CHANGES:
            self._omitted_changes += 1
            return
        self._changes.append(
            DecisionChange(
                at=self._transport.now(),
                topic=topic,
                flow=flow,
                decision=decision,
                policy=policy,
                reason=reason,
            )
        )

    def _summary(self) -> ReplayReport:
        return ReplayReport(
            messages=self._messages,
            duration=self._transport.now(),
            streams=tuple(map(_stream_count, self._coordinator.streams)),
            changes=tuple(self._changes),
            notes=(*dict.fromkeys(self._notes), *self._remarks()),
            unseen=self._omitted_changes,
        )

    def _remarks(self) -> Iterator[str]:
        """Yield what is to be said of all that was played so far."""
        for action in self._transport.actions:
            yield from action.notes()
        for stream in self._coordinator.streams:
            if isinstance(stream, ObservedActionStream):
                yield f"{stream.spec.topic}: a plan that only observes sees no goals of ROS 2"
        yield from _strangers(self._coordinator.streams)


def _strangers(streams: Iterable[GuardedStream]) -> Iterator[str]:
    for each in streams:
        if names := ", ".join(filter(None, each.strangers)):
            yield f"{each.spec.topic}: not in the plan: {names}"


def _ignore_message(_message: bytes) -> None:
    """Play nothing: the guard itself said this."""


def _stream_count(stream: GuardedStream) -> ReplayStreamCounts:
    publishers = {flow.name: flow.publisher for flow in stream.spec.flows}
    return ReplayStreamCounts(
        topic=stream.spec.topic,
        nodes=tuple(stage.id for stage in stream.spec.stages),
        flows=tuple(
            ReplayFlowCounts(
                flow=name,
                publisher=publishers.get(name, ""),
                passed=tally.passed,
                held=tally.held,
                dropped=tally.dropped,
                modified=tally.modified,
            )
            for name, tally in stream.pipeline.tallies.items()
        ),
        stops=stream.stop_controller.stop_count,
    )
