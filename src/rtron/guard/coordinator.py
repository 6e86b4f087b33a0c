"""The coordinator: all coordination nodes of a plan in one process, and their reports."""

import logging
import time
from collections.abc import Callable, Sequence
from functools import partial

from rtron.guard.action.common.simple_goals import SimpleGoalStream
from rtron.guard.action.ros1.simple_goals import ActionTopicObserver, action_of_result
from rtron.guard.action.ros1.stream import Ros1ActionStream
from rtron.guard.action.ros2.simple_goals import ActionStatusObserver
from rtron.guard.action.ros2.stream import ObservedActionStream, Ros2ActionStream
from rtron.guard.core.alarms import Alarms
from rtron.guard.core.diagnostics import (
    active_text,
    alarm_statuses,
    emergency_statuses,
    event_statuses,
    rate_statuses,
    stream_statuses,
)
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.log_throttle import PERIOD, LogThrottle
from rtron.guard.core.observation_inputs import ObservationInputs
from rtron.guard.core.observations import Observations
from rtron.guard.core.report_messages import (
    DIAGNOSTICS,
    FLOAT64,
    STRING,
    Status,
    diagnostics_message,
    float64_message,
    string_message,
)
from rtron.guard.core.stream import GuardedStream
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.core.stream_settings import StreamUpdate
from rtron.guard.core.timers import DeadlineTimer
from rtron.guard.intrusion_latch import IntrusionLatch
from rtron.guard.transport.common.protocol import Output, Peer, Transport
from rtron.messages.common.encoding import Encoding
from rtron.policies.authority.command_lease import LeaseAnswer
from rtron.policies.mission.rule_status import RuleStatus
from rtron.vocabulary import GUARD_NODE, PRIVATE_ROOT, SECOND, Mode, Stream

log = logging.getLogger(__name__)

_FPS_PERIOD = SECOND // 10


class Coordinator:
    """Opens the streams on a transport and reports: `~active` on change, `/diagnostics` at 1 Hz.

    A dry run forwards everything and reports what it would have decided.
    """

    def __init__(
        self,
        transport: Transport,
        streams: Sequence[Stream],
        observations: Observations | None = None,
        *,
        dry_run: bool = False,
        handover: HandoverState | None = None,
        node: str = GUARD_NODE,
    ) -> None:
        """`handover` is the state that the guard before has left; `node` publishes the reports."""
        self.observations = observations or Observations()
        self.alarms = Alarms()
        self.emergency = ""
        """The reason of the emergency stop in force, "" if there is none."""
        self.on_observed: Callable[[], None] = lambda: None
        """Called when an event or a frame was observed."""
        self.on_lease_answer: Callable[[str, str, LeaseAnswer], None] = _ignore_answer
        """Called when a lease was asked for something: its name, who asked for what, the answer."""
        self.other_statuses: Callable[[], list[Status]] = list
        """Tells the state of the streams that another process of the guard carries."""
        self._transport = transport
        self._dry_run = dry_run
        self._node = node
        self._handover = handover or HandoverState()
        self.intrusions = IntrusionLatch(self._handover)
        self.streams = [self._create_stream(stream) for stream in streams]
        self._connect_simple_goals()
        self._inputs = ObservationInputs(transport, self.observations, self._on_observed)
        self._recheck_scheduled = False
        self._log_throttle = LogThrottle()
        self._unsettled_rules: set[str] = set()
        self._deadline_timer = DeadlineTimer(
            transport, self._deadline, self._update_time, self.recheck
        )
        self._diagnostics: Output | None = None
        self._report_number = 0
        self.observations.mission.on_change = self._on_rule_change

    def open(self) -> None:
        """Join the graph with every coordination node, and start to report."""
        self.open_nodes()
        for monitor in self.observations.monitors:
            self._advertise_rate(monitor.id)
        self._report_periodically()

    def open_nodes(self) -> None:
        """Join the graph with every coordination node; each tells who is in control."""
        self.open_streams()
        diagnostics = DIAGNOSTICS[self._transport.encoding]
        self._diagnostics = self._advertise(self._node, "/diagnostics", diagnostics.type)
        self._diagnostics.learn_type(diagnostics)
        for stream in self.streams:
            self._publish_owner(stream)

    def open_streams(self) -> None:
        """Join the graph without reports: a recording has no reader of them."""
        for stream in self.streams:
            stream.open()
        self._inputs.open()

    def statuses(self) -> list[Status]:
        """Return the state of every stream, image node and rule."""
        now = self._transport.now()
        return [
            *self.other_statuses(),
            *self.stream_statuses(),
            *rate_statuses(self.observations, now),
            *event_statuses(self._inputs.losses.values(), now),
            *emergency_statuses(self.emergency, dry_run=self._dry_run),
            *alarm_statuses(self.alarms, now),
        ]

    def follow_events(self, on_event: Callable[[str, Peer, bytes], None]) -> None:
        """Call `on_event` with the topic, the publisher and the message of each event."""
        self._inputs.on_event = on_event

    def lost_events(self) -> dict[str, int]:
        """Return how many events did not reach the guard, by the topic where any was lost."""
        lost = {topic: sum(each.before.values()) for topic, each in self._inputs.losses.items()}
        return {topic: count for topic, count in lost.items() if count}

    def stream_statuses(self) -> list[Status]:
        """Return the state of the streams and rules here, with what was lost until now."""
        now = self._transport.now()
        for stream in self.streams:
            stream.losses.update(stream.lost_behind, now)
        return list(stream_statuses(self.streams, self.observations, now))

    def apply_updates(self, observations: Observations, updates: Sequence[StreamUpdate]) -> None:
        """Put other settings of the streams in force; call `recheck` afterwards.

        All streams change before any message that can no longer be held is dropped.
        """
        self.observations = observations
        now = self._transport.now()
        pairs = zip(self.streams, updates, strict=True)
        dropped = [(stream, stream.apply_update(each, now)) for stream, each in pairs]
        for stream, releases in dropped:
            stream.pipeline.drop_held(releases)
        self.schedule_deadline()

    def _create_stream(self, stream: Stream) -> GuardedStream:
        context = StreamContext(self._transport, self.observations, self._handover, self._dry_run)
        if stream.is_ros2_action:
            return self._create_ros2_action(stream, context)
        if stream.mode is Mode.ENFORCE and stream.action:
            action = Ros1ActionStream(stream, context)
            action.stops.on_goal_stopped = partial(self._on_goal_stopped, action)
            return action
        if stream.done and self._transport.encoding is Encoding.CDR:
            status = ActionStatusObserver(stream.done, context)
            return SimpleGoalStream(stream, context, stream.done, status)
        if stream.mode is Mode.ENFORCE and (name := action_of_result(stream)):
            return SimpleGoalStream(stream, context, name, ActionTopicObserver(name, context))
        return GuardedStream(stream, context)

    def _create_ros2_action(self, stream: Stream, context: StreamContext) -> GuardedStream:
        """Return an action of ROS 2; its requests cannot be observed, only served."""
        create_endpoints = getattr(self._transport, "action_endpoints", None)
        if stream.mode is not Mode.ENFORCE or create_endpoints is None:
            return ObservedActionStream(stream, context)
        action = Ros2ActionStream(stream, context, create_endpoints)
        action.stops.on_goal_stopped = partial(self._on_goal_stopped, action)
        return action

    def _connect_simple_goals(self) -> None:
        """Attach streams of goals without an id to their action, where that is guarded too."""
        actions = {
            each.name: each
            for each in self.streams
            if isinstance(each, Ros1ActionStream | Ros2ActionStream)
        }
        for each in self.streams:
            if isinstance(each, SimpleGoalStream) and each.spec.mode is Mode.ENFORCE:
                action = actions.get(each.action)
                if action:
                    each.attach(action.goals.queue, action.stops)

    def _on_goal_stopped(
        self, action: Ros1ActionStream | Ros2ActionStream, node: str, why: str
    ) -> None:
        """Bar the server of a stopped goal from moving the robot, until the goal is over."""
        for stream in self.streams:
            if stream is action:
                continue
            if why:
                stream.bar(action.name, node, why)
            else:
                stream.release(action.name)

    def _on_observed(self) -> None:
        self.schedule_deadline()
        self.on_observed()

    def schedule_deadline(self) -> None:
        """Be called when something changes by time alone, if not before."""
        self._deadline_timer.arm()

    def _deadline(self) -> int | None:
        return self.observations.deadline(self._transport.now())

    def _update_time(self, now: int) -> None:
        self.observations.update_time(now)

    def _on_rule_change(self, rule_status: RuleStatus) -> None:
        self._log_rule_change(rule_status)
        if not self._recheck_scheduled:
            self._recheck_scheduled = True
            self._transport.call_at(self._transport.now(), self.recheck)

    def _log_rule_change(self, rule_status: RuleStatus) -> None:
        """Log that a rule began or ceased to block; of one that flickers, log its last state."""
        now, rule = self._transport.now(), rule_status.rule.name
        if self._log_throttle.allows(rule, now):
            _log_rule_status(rule_status)
        elif rule not in self._unsettled_rules:
            self._unsettled_rules.add(rule)
            self._transport.call_at(now + PERIOD, partial(self._log_settled_rule, rule_status))

    def _log_settled_rule(self, rule_status: RuleStatus) -> None:
        self._unsettled_rules.discard(rule_status.rule.name)
        _log_rule_status(rule_status)

    def recheck(self) -> None:
        """Let every stream check whether the flow that moves the robot may go on."""
        self._recheck_scheduled = False
        now = self._transport.now()
        for stream in self.streams:
            stream.recheck(now)

    def _advertise(self, node: str, topic: str, type: str) -> Output:
        return self._transport.advertise(node, topic, type)

    def _publish_owner(self, stream: GuardedStream) -> None:
        name = stream.spec.topic.strip("/").replace("/", "_")
        topic = f"{stream.nodes[0]}/{name}/active"
        active = self._advertise(stream.nodes[0], topic, STRING.type)
        active.learn_type(STRING)
        stream.on_state_change = partial(_publish_active, stream, active, self._transport.encoding)
        stream.on_state_change()

    def _advertise_rate(self, monitor: str) -> None:
        node = f"{PRIVATE_ROOT}/{monitor}"
        output = self._advertise(node, f"{node}/fps", FLOAT64.type)
        output.learn_type(FLOAT64)
        self._publish_rate(monitor, output)

    def _publish_rate(self, monitor: str, output: Output) -> None:
        now = self._transport.now()
        fps = self.observations.rates.monitors[monitor].rate(now).fps
        output.publish(float64_message(self._transport.encoding, fps))
        self._transport.call_at(now + _FPS_PERIOD, partial(self._publish_rate, monitor, output))

    def _report_periodically(self) -> None:
        self._transport.call_at(self._transport.now() + SECOND, self._report_periodically)
        self.publish_diagnostics(self.statuses())

    def publish_diagnostics(self, statuses: Sequence[Status]) -> None:
        """Publish the state of the guard, or of a part of it."""
        if self._diagnostics is not None:
            self._report_number += 1
            fields = (self._report_number, time.time_ns(), statuses)
            self._diagnostics.publish(diagnostics_message(self._transport.encoding, *fields))


def _log_rule_status(rule_status: RuleStatus) -> None:
    log.warning("blocked: %s" if rule_status.is_blocking else "free: %s", rule_status.reason)


def _publish_active(stream: GuardedStream, active: Output, encoding: Encoding) -> None:
    text = active_text(stream)
    log.info("%s: %s", stream.spec.topic, text)
    active.publish(string_message(encoding, text), latched_by=GUARD_NODE)


def _ignore_answer(_lease: str, _what: str, _answer: LeaseAnswer) -> None:
    """Do nothing about an answer."""
