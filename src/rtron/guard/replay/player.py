"""A recording played through the same pipelines as a running app, with the recording's clock."""

from collections.abc import Callable, Iterable, Iterator
from functools import partial

from rtron.guard.action.ros1.stream import GuardedAction
from rtron.guard.action.ros1.topics import STATUS
from rtron.guard.action.ros2.observed import ObservedAction
from rtron.guard.core.coordinator import Host
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import senses_of
from rtron.guard.core.stream import GuardedStream
from rtron.guard.measurement.run import Measuring
from rtron.guard.replay.recorded_actions import RecordedRequests
from rtron.guard.replay.recorded_streams import Places, Recorded
from rtron.guard.transport.common.protocol import Peer, Receive
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    SECOND,
    SERVER,
    ActionPart,
    Change,
    FlowCount,
    Plan,
    Replay,
    Run,
    StreamCount,
    Verdict,
    flow_topic,
    part_topic,
)

MOST_CHANGES = 10_000
LONGEST_GAP = 60 * SECOND
_STEP = 10_000
Message = tuple[int, Recorded, bytes]
"""A recorded message: its time (ns), what it belongs to, and its bytes as the guard sees them."""


class Player:
    """Plays messages in the order of their times; what the guard would have said is noted.

    Time that goes back in a recording stands still here. `measured`: figures are kept.
    """

    def __init__(self, plan: Plan, *, measured: bool = False) -> None:
        self._places = Places.of(plan)
        encoding = Encoding.ROS1 if plan.ros == 1 else Encoding.CDR
        self._transport = RecordedRequests(encoding, self._places.definitions)
        self._measuring = Measuring(plan, self._transport) if measured else None
        senses = self._measuring.senses if self._measuring else senses_of(plan)
        self._host = Host(self._transport, self._places.streams, senses)
        self._receivers: dict[Recorded, Receive] = {}
        self._changes: list[Change] = []
        self._unseen = 0
        self._notes: list[str] = []
        self._messages = 0
        self._began: int | None = None
        if self._measuring:
            self._measuring.watch(self._host.guarded)
        self._host.guard()
        told = (pair for action in self._transport.actions for pair in action.receivers())
        self._requests: dict[str, Receive] = dict(told)
        for guarded in self._host.guarded:
            self._serve(guarded)
        for guarded in self._host.guarded:
            guarded.pipeline.changed = partial(self._changed, guarded.stream.topic)
            guarded.told = partial(self._told, guarded)

    def play(self, messages: Iterable[Message], progress: Callable[[int], None]) -> Replay:
        """Play messages and return what was found so far; `progress` is told how many were read."""
        transport, receivers = self._transport, self._receivers
        for time, recorded, data in messages:
            if self._began is None:
                self._began = time
            ahead = time - self._began - transport.now()
            if ahead > 0:
                self._pass_time(ahead)
            receive = receivers.get(recorded) or self._connect(recorded)
            receive(data)
            self._messages += 1
            if self._messages % _STEP == 0:
                progress(self._messages)
        return self._found()

    def _serve(self, guarded: GuardedStream) -> None:
        """Let the server of an action be there, although its status may not be recorded."""
        info = standard_info(STATUS, self._transport.encoding)
        if isinstance(guarded, GuardedAction) and info:
            status = part_topic(guarded.name, ActionPart.STATUS)
            for server in guarded.stream.successors[:1]:
                self._transport.publisher(flow_topic(status, SERVER), Peer(server, info))

    def figures(self) -> Run:
        """Return what was measured of all that was played."""
        if self._measuring is None:
            raise AssertionError("nothing was measured")
        return self._measuring.run()

    def _pass_time(self, duration: int) -> None:
        """Let time pass; a long gap is mostly jumped over, since nothing can happen in it."""
        stepped = min(duration, LONGEST_GAP)
        self._transport.advance(stepped)
        if duration > stepped:
            self._notes.append(f"nothing was recorded for {duration / SECOND:.0f} s")
            self._transport.jump(duration - stepped)

    def _connect(self, recorded: Recorded) -> Receive:
        receive = self._requests.get(recorded.topic) or self._publisher(recorded)
        self._receivers[recorded] = receive
        return receive

    def _publisher(self, recorded: Recorded) -> Receive:
        topic = self._places.topic(recorded)
        if not recorded.publisher:
            self._note(recorded)
        return self._transport.publisher(topic, self._places.peer(recorded)) if topic else _skip

    def _note(self, recorded: Recorded) -> None:
        taken = self._places.publisher(recorded)
        who = f"taken for {taken}" if taken else "nobody that the plan knows"
        self._notes.append(f"{recorded.topic}: its publisher is not recorded: {who}")

    def _changed(self, topic: str, verdict: Verdict) -> None:
        self._add(topic, verdict.flow, verdict.decision, verdict.policy, verdict.reason)

    def _told(self, guarded: GuardedStream) -> None:
        if guarded.stopper.why:
            stopped = guarded.stopper.stopped
            self._add(guarded.stream.topic, stopped, "stop", "", guarded.stopper.why)

    def _add(self, topic: str, flow: str, decision: str, policy: str, reason: str) -> None:
        if len(self._changes) >= MOST_CHANGES:
            self._unseen += 1
            return
        self._changes.append(
            Change(
                at=self._transport.now(),
                topic=topic,
                flow=flow,
                decision=decision,
                policy=policy,
                reason=reason,
            )
        )

    def _found(self) -> Replay:
        return Replay(
            messages=self._messages,
            duration=self._transport.now(),
            streams=tuple(map(_count, self._host.guarded)),
            changes=tuple(self._changes),
            notes=(*dict.fromkeys(self._notes), *self._remarks()),
            unseen=self._unseen,
        )

    def _remarks(self) -> Iterator[str]:
        """Yield what is to be said of all that was played so far."""
        for action in self._transport.actions:
            yield from action.notes()
        for guarded in self._host.guarded:
            if isinstance(guarded, ObservedAction):
                yield f"{guarded.stream.topic}: a plan that only observes sees no goals of ROS 2"
        yield from _strangers(self._host.guarded)


def _strangers(guarded: Iterable[GuardedStream]) -> Iterator[str]:
    for each in guarded:
        if named := ", ".join(filter(None, each.strangers)):
            yield f"{each.stream.topic}: not in the plan: {named}"


def _skip(_message: bytes) -> None:
    """Play nothing: the guard itself said this."""


def _count(guarded: GuardedStream) -> StreamCount:
    publishers = {flow.name: flow.publisher for flow in guarded.stream.flows}
    return StreamCount(
        topic=guarded.stream.topic,
        nodes=tuple(stage.id for stage in guarded.stream.stages),
        flows=tuple(
            FlowCount(
                flow=name,
                publisher=publishers.get(name, ""),
                passed=tally.passed,
                held=tally.held,
                dropped=tally.dropped,
                modified=tally.modified,
            )
            for name, tally in guarded.pipeline.tallies.items()
        ),
        stops=guarded.stopper.stops,
    )
