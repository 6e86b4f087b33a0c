"""What the guard would do with a message: its own policies in memory, in the state of the moment.

A preview is asked of one message and forgotten: nothing that it decides changes the next one. It
has no authority: the guard decides again. What is not known counts as forbidden: a rule whose state
the guard does not report, frames that nobody counts.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from rtron.bridge.agents.guard_report import GuardReport
from rtron.bridge.common.message_types import MessageTypes
from rtron.errors import WireError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import codec_of
from rtron.guard.core.observations import Observations, observations_of
from rtron.guard.core.stream import GuardedStream
from rtron.guard.lanes.command.board_observations import BoardMonitor
from rtron.guard.lanes.exchange.board import RateRecord
from rtron.guard.replay.recorded_actions import RecordedActionTransport
from rtron.guard.replay.recorded_streams import RecordedStreams
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages import Definition
from rtron.messages.common.json_decoder import decode_json
from rtron.messages.common.json_encoder import encode_json
from rtron.messages.ros2.actions import NO_ID, GoalMessage
from rtron.policies.authority.command_lease import Person
from rtron.policies.state_transfer import PolicyState
from rtron.vocabulary import (
    SECOND,
    Decision,
    Mode,
    Plan,
    Stage,
    Velocity,
    Verdict,
    flow_topic,
    matches_node,
    normalise_type,
)

MAX_MESSAGE = 1 << 16
"""The largest message that is looked at, bytes."""
_NOW = 1000 * SECOND
"""The time of a preview: far enough from 0 that nothing begins there."""
_PASSES = (Decision.PASS, Decision.MODIFY)


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What the guard would do with a message, by which rule, and what the limits are.

    `value` is what was asked for, `limits` what it may be at most, both by quantity with its unit.
    `instead` is what would go on in its place.
    """

    passes: bool
    decision: str
    rule: str
    reason: str
    value: dict[str, float]
    limits: dict[str, float]
    instead: dict[str, Any] | None = None

    @property
    def exceeded(self) -> dict[str, float]:
        """The limits that the values exceed."""
        return {
            name: limit
            for name, limit in self.limits.items()
            if self.value.get(name, 0.0) > limit + _ROUNDING
        }


_ROUNDING = 1e-9


class GuardPreview:
    """Judges the messages of one node under a plan."""

    def __init__(self, plan: Plan, node: str, types: MessageTypes) -> None:
        self._plan = replace(plan, cell=())
        self._node = node
        self._types = types

    def judge(
        self, topic: str, message: object, report: GuardReport, now: int, *, as_holder: bool = False
    ) -> Judgement:
        """Return what the guard would do with a message, given as JSON, of a guarded topic.

        `as_holder`: as if the node had the lease. WireError if the message is none of its type, or
        the plan has no flow of the node there.
        """
        trial = _Trial(self._plan, self._types, report, now)
        stream = trial.stream(topic)
        flow = self._flow(stream)
        definition = self._definition(stream)
        data, _ = encode_json(definition, self._types.encoding, message, now, MAX_MESSAGE)
        trial.set_leases(self._node, as_holder=as_holder)
        verdict = trial.decide(stream, flow, self._peer(stream, definition), data)
        codec = codec_of(self._type_info(stream, definition), self._types.encoding)
        value = _quantities(codec.decode(data)) if codec else {}
        return Judgement(
            passes=verdict.decision in _PASSES,
            decision=verdict.decision.value,
            rule=_rule(stream, verdict),
            reason=verdict.reason,
            value=value,
            limits=dict(_limits(stream)) if codec else {},
            instead=self._changed(definition, verdict, trial.sent),
        )

    def _flow(self, stream: GuardedStream) -> str:
        for flow in stream.spec.flows:
            if matches_node(flow.publisher, self._node):
                return flow.name
        raise WireError(f"the plan guards {stream.spec.topic} and has no flow of {self._node}")

    def _definition(self, stream: GuardedStream) -> Definition:
        if stream.spec.is_ros2_action:
            return self._types.action(stream.spec.type).goal
        return self._types.message(stream.spec.type)

    def _type_info(self, stream: GuardedStream, definition: Definition) -> TypeInfo:
        type = normalise_type(stream.spec.type)
        text = "" if stream.spec.is_ros2_action else self._types.text(type)
        return TypeInfo(type, definition.md5sum, text)

    def _peer(self, stream: GuardedStream, definition: Definition) -> Peer:
        return Peer(self._node, self._type_info(stream, definition))

    def _changed(
        self, definition: Definition, verdict: Verdict, sent: list[bytes]
    ) -> dict[str, Any] | None:
        if verdict.decision is not Decision.MODIFY or not sent:
            return None
        return decode_json(definition, self._types.encoding, sent[-1])


class _Trial:
    """A guard in memory that lives for one message."""

    def __init__(self, plan: Plan, types: MessageTypes, report: GuardReport, now: int) -> None:
        self._report = report
        self._reported_at = now
        self.sent: list[bytes] = []
        places = RecordedStreams.from_plan(plan)
        self._transport = RecordedActionTransport(types.encoding, places.definitions)
        self._transport.jump(_NOW)
        self._observations = _observations(plan, report, now)
        self._coordinator = Coordinator(self._transport, places.streams, self._observations)
        self._coordinator.open_streams()
        self._observations.update_time(_NOW)
        self._set_rules()

    def stream(self, topic: str) -> GuardedStream:
        """Return the stream of a topic; WireError if the plan does not guard it."""
        for stream in self._coordinator.streams:
            if stream.spec.topic == topic and stream.spec.mode is Mode.ENFORCE:
                return stream
        raise WireError(f"the plan does not guard {topic[:80]}")

    def set_leases(self, node: str, *, as_holder: bool) -> None:
        """Let those hold the leases who hold them, or the node, which counts as neutral before."""
        for name, lease in self._observations.leases.items():
            holder = node if as_holder else self._report.holder(name)
            if holder:
                lease.give(holder, Person("the guard", None), _NOW, "")
        for stream in self._coordinator.streams:
            grant = stream.lease.grant(_NOW) if stream.lease else None
            if grant and grant.holder.name == node:
                neutral = PolicyState(neutral_grant=grant.number)
                stream.pipeline.policies[0].restore_state(neutral, _NOW)

    def decide(self, stream: GuardedStream, flow: str, peer: Peer, data: bytes) -> Verdict:
        """Return the verdict on a message."""
        topic = stream.spec.topic
        stream.set_listeners(_ignore_type, partial(_note, self.sent))
        if not stream.spec.is_ros2_action:
            self._transport.publisher(flow_topic(topic, flow), peer)
        if why := self._report.stop_reason(topic, self._reported_at):
            stream.brake("report", why)
        self.sent.clear()
        message = GoalMessage.of(NO_ID, data) if stream.spec.is_ros2_action else data
        verdict = stream.receive(flow, message)
        if verdict is None:
            raise WireError(f"{topic}: the policies fail on this message")
        return verdict

    def _set_rules(self) -> None:
        """Let the rules block as the guard reports; those that it does not report block."""
        for name, status in self._observations.mission.statuses.items():
            blocks = self._report.rule_blocks(name, self._reported_at)
            status.is_pending = blocks is not False
            if blocks is not None:
                status.unknown_events = ()
            if blocks is False:
                status.deactivate()


def _observations(plan: Plan, report: GuardReport, now: int) -> Observations:
    """Return what the policies depend on, with the frame rates that the guard reports."""
    planned = observations_of(plan)
    for monitor in plan.fps_monitor:
        fps = report.frame_rate(monitor.id, now)
        record = RateRecord(fps, _NOW if fps else 0, _NOW)
        planned.rates.monitors[monitor.id] = BoardMonitor(monitor, partial(_same, record))
    return replace(planned, monitors=(), events=())


def _same(record: RateRecord) -> RateRecord:
    return record


def _rule(stream: GuardedStream, verdict: Verdict) -> str:
    """Return which policy has decided, at which coordination node of the plan."""
    stages = [each for each in stream.spec.stages if each.settings.policy is verdict.policy]
    nodes = ", ".join(each.id for each in stages)
    return f"{verdict.policy} ({nodes})" if nodes else str(verdict.policy)


def _limits(stream: GuardedStream) -> Iterator[tuple[str, float]]:
    """Yield what the stream's velocities may be at most: the lowest of each quantity."""
    speed = stream.limit(_NOW)
    if speed is not None:
        yield "speed m/s", round(speed, 4)
    for stage in stream.spec.stages:
        yield from _planned_limits(stage)


def _planned_limits(stage: Stage) -> Iterator[tuple[str, float]]:
    settings = stage.settings
    found = {
        "turn rad/s": settings.max_turn_limit,
        "side m/s": settings.max_side_limit,
        "acceleration m/s2": settings.max_accel_limit,
    }
    yield from ((name, limit) for name, limit in found.items() if limit is not None)


def _quantities(velocity: Velocity) -> dict[str, float]:
    return {
        "speed m/s": velocity.speed,
        "turn rad/s": velocity.angular_speed,
        "side m/s": velocity.side_speed,
    }


def _ignore_type(_info: TypeInfo) -> None:
    """Take the type of an output for what it is."""


def _note(sent: list[bytes], _flow: str, message: bytes) -> None:
    sent.append(message)
