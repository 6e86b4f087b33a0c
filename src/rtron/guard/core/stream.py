"""One stream of the plan on a transport: its inputs, its pipeline and its outputs."""

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from rtron.guard.core.handover_state import FlowOrder
from rtron.guard.core.lease_text import lease_text
from rtron.guard.core.losses import Losses
from rtron.guard.core.observations import Observations
from rtron.guard.core.override_policy import OverridablePolicy
from rtron.guard.core.pipeline import Pipeline
from rtron.guard.core.stop_controller import StopController
from rtron.guard.core.stream_endpoints import InputRules, StreamContext, StreamEndpoints
from rtron.guard.core.stream_settings import (
    MessageFormat,
    StreamUpdate,
    create_policies,
    prepare_update,
    revision_of,
    rules_met_by_flow,
    with_defaults,
)
from rtron.guard.core.timers import DeadlineTimer
from rtron.guard.core.velocity_gate import VelocityGate
from rtron.guard.system.process_attributes import exit_out_of_memory
from rtron.guard.transport.common.protocol import MessageHandler, Peer, TypeInfo
from rtron.policies import Policy, Release
from rtron.policies.authority.command_lease import CommandLease
from rtron.policies.authority.lease import Lease
from rtron.policies.mission.rule_status import RuleStatus
from rtron.vocabulary import (
    PRIVATE_ROOT,
    UNAPPROVED,
    Decision,
    Stream,
    Velocity,
    Verdict,
    matches_node,
)

if TYPE_CHECKING:
    from rtron.guard.incidents.stream_tap import StreamTap
    from rtron.guard.measurement.histogram import LatencyStatistics
    from rtron.guard.measurement.stream import StreamMeasurement
    from rtron.messages.common.velocity import VelocityCodec

log = logging.getLogger(__name__)

_DROP, _HOLD = Decision.DROP, Decision.HOLD


class GuardedStream:
    """Takes the messages of the flows, asks the pipeline, and sends those that pass."""

    def __init__(
        self, stream: Stream, context: StreamContext, rules: InputRules | None = None
    ) -> None:
        observations = context.observations
        self.spec = with_defaults(stream)
        self.nodes = tuple(f"{PRIVATE_ROOT}/{stage.id}" for stage in stream.stages)
        self.dry_run = context.dry_run
        self.endpoints = StreamEndpoints(
            self.spec, self.nodes, self, rules or InputRules(), context
        )
        self.strangers = self.endpoints.strangers
        self.losses = Losses(stream.topic)
        self._transport = context.transport
        names = [*(flow.name for flow in stream.flows), UNAPPROVED]
        policies = create_policies(self.spec, observations)
        self.override_policies = {
            k: v for k, v in policies.items() if isinstance(v, OverridablePolicy)
        }
        self._gate = VelocityGate(self.spec)
        self._order = FlowOrder(stream.topic, context.handover)
        self.pipeline = Pipeline(tuple(policies.values()), names, self._on_passed, self._gate)
        self.pipeline.revise(revision_of(stream))
        self.stop_controller = StopController(stream, self._send_message)
        self.stop_controller.on_slowed = self._on_slowed
        for policy in policies.values():
            self._connect_lease(policy)
        self.on_state_change: Callable[[], None] = lambda: None
        self.measurement: StreamMeasurement | None = None
        self.latencies: LatencyStatistics | None = None
        self.tap: StreamTap | None = None
        self._mission = observations.mission
        self._rules_met = rules_met_by_flow(stream)
        self.codec: VelocityCodec | None = None
        self._is_open = False
        self._brake_reasons: dict[str, str] = {}
        self._last_state: tuple[str | None, str] = (None, "")
        self._deadline_timer = DeadlineTimer(
            context.transport, self._next_deadline, self._tick, self._notify_state_change
        )

    def open(self) -> None:
        """Join the graph."""
        self._join_graph()
        self._is_open = True
        for why in self._brake_reasons.values():
            self._stop_robot(why)

    def _join_graph(self) -> None:
        self.endpoints.open()
        self.endpoints.outputs.greet(self._greeting)
        self._subscribe_done()

    def _subscribe_done(self) -> None:
        if self.spec.done:
            self.endpoints.subscribe_successors(self.spec.done, "", self._connect_done)

    def _connect_done(self, _peer: Peer) -> MessageHandler:
        return self.on_action_done

    def set_listeners(
        self, on_type: Callable[[TypeInfo], None], on_sent: Callable[[str, bytes], None]
    ) -> None:
        """Call `on_type` when the type is learned, and `on_sent` with each message and its flow."""
        self.endpoints.outputs.set_listeners(on_type, on_sent)

    @property
    def details(self) -> Mapping[str, str]:
        """More entries for the diagnostics."""
        return {}

    def brake(self, by: str, why: str) -> None:
        """Block all messages and keep the robot stopped, until `release(by)`.

        A stream that is not open yet stops the robot as it opens.
        """
        self.pipeline.bar(by, self.pipeline.tallies, why)
        self._brake_reasons[by] = why
        if self._is_open:
            self._stop_robot(why)

    @property
    def brake_reason(self) -> str:
        """Why the robot is kept stopped, "" if it is not."""
        return next(iter(self._brake_reasons.values()), "")

    def _greeting(self) -> bytes | None:
        """Return what a new subscriber hears first while the robot is kept stopped."""
        if not self._brake_reasons:
            return None
        return self.stop_controller.stop_message(self._transport.now())

    def bar(self, by: str, publisher: str, why: str) -> None:
        """Block a publisher until `release(by)`; stop the robot if that publisher moves it."""
        flows = [f.name for f in self.spec.flows if matches_node(f.publisher, publisher)]
        self.pipeline.bar(by, flows, why)
        self.recheck(self._transport.now())

    def release(self, by: str) -> None:
        """Remove the brakes and bars of `by`: the policies decide again."""
        self.pipeline.unbar(by)
        was_braked = self._brake_reasons.pop(by, None)
        if self._brake_reasons:
            self.stop_controller.set_reason(self.brake_reason)
        else:
            if was_braked and self.lease:
                self.lease.require_neutral(self._transport.now())
            self.stop_controller.release_brake()
            for policy in self.override_policies.values():
                policy.reevaluate(self._transport.now())
        self.recheck(self._transport.now())

    def prepare_update(
        self, stream: Stream, observations: Observations, rule_statuses: Mapping[str, RuleStatus]
    ) -> StreamUpdate:
        """Return an update for `apply_update`; nothing changes yet. PlanError if it is invalid."""
        format = MessageFormat(self.endpoints.type_info, self.codec)
        return prepare_update(self.spec, with_defaults(stream), observations, rule_statuses, format)

    def apply_update(self, update: StreamUpdate, now: int) -> Sequence[Release]:
        """Put other settings in force; return the held messages that can no longer be held.

        Pass them to `pipeline.drop_held` once all streams have their update.
        """
        self.spec = update.stream
        self.endpoints.update(update.stream, update.md5sum)
        self._rules_met = rules_met_by_flow(self.spec)
        dropped: list[Release] = []
        for at, stage in enumerate(self.spec.stages):
            if policy := update.policies.get(stage.id):
                self._connect_lease(policy)
                self._inherit_overrides(stage.id, policy)
                dropped += self.pipeline.replace(at, policy, now)
        self.pipeline.revise(revision_of(self.spec))
        return dropped

    def _connect_lease(self, policy: Policy) -> None:
        """Let a policy that needs a lease know which messages move nothing."""
        if isinstance(policy, Lease):
            policy.is_neutral = self._is_neutral

    def _is_neutral(self, message: object) -> bool:
        return isinstance(message, bytes) and not self.stop_controller.is_moving(message)

    @property
    def lease(self) -> CommandLease | None:
        """The lease that the flows need, None if they need none."""
        first = self.pipeline.policies[0]
        return first.lease if isinstance(first, Lease) else None

    @property
    def lease_text(self) -> str:
        """Who holds the lease that the flows need, "" if they need none."""
        return lease_text(self.lease, self._transport.now()) if self.lease else ""

    def _inherit_overrides(self, node_id: str, policy: Policy) -> None:
        if isinstance(policy, OverridablePolicy):
            policy.inherit_overrides(self.override_policies[node_id])
            self.override_policies[node_id] = policy

    def recheck(self, now: int) -> None:
        """Stop or slow the robot if the flow that moves it may not go on as before."""
        flow = self.stop_controller.moving_flow
        if flow and (why := self.pipeline.refusal(flow.name, now)):
            self.stop_controller.refuse(why, now)
        self._slow_down(now)
        self._deadline_timer.run_due(now)
        self._notify_state_change()

    def recheck_lease(self, now: int) -> None:
        """Stop the robot if the flow that moves it has lost the lease; tell who holds it."""
        self._last_state = (None, "another lease")
        self.recheck(now)

    def _slow_down(self, now: int) -> None:
        """Repeat the last command more slowly, if it is now above a limit."""
        for policy in self.override_policies.values():
            if self.stop_controller.moving_flow:
                self.stop_controller.slow_down(policy.bounded, now)

    def _on_slowed(self, velocity: Velocity, now: int) -> None:
        for policy in self.override_policies.values():
            policy.note_sent(velocity, now)

    def on_action_done(self, _message: bytes = b"") -> None:
        """Know that the message in progress is done: the next one may go."""
        now = self._transport.now()
        if self.measurement:
            self.measurement.finish_goal_without_id(now)
        self.pipeline.finish_action(now)
        self._deadline_timer.run_due(now)

    def _measure_goal_end(self, id: bytes) -> None:
        if self.measurement:
            self.measurement.finish_goal(id, self._transport.now())

    def _stop_robot(self, why: str) -> None:
        """Stop the robot while all messages are blocked."""
        if not self.stop_controller.is_ready:
            self.endpoints.learn_standard()
        self.stop_controller.brake(why, self._transport.now())
        self.recheck(self._transport.now())

    def learn_codec(self, codec: "VelocityCodec | None") -> None:
        """Learn how the velocities in the messages are laid out; None if nobody can read them."""
        self._gate.learn(codec)
        if codec is None:
            return
        self.codec = codec
        self.stop_controller.learn(codec)
        if self.measurement:
            self.measurement.learn(codec)
        for policy in self.override_policies.values():
            policy.learn(codec)

    def learn_numbers(self, check: Callable[[bytes], object]) -> None:
        """Learn how to refuse commands whose floats are no numbers."""
        self._gate.learn_numbers(check)

    def resume_order(self) -> None:
        """Let the flows have the order that the guard before has left: the first is back."""
        self._order.resume(self.pipeline.policies, self._transport.now())

    def store_order(self) -> None:
        """Store the order of the flows for the next guard, if it has changed."""
        self._order.store(self.pipeline.policies, self._transport.now())

    def forget_flow(self, flow: str) -> None:
        """Let others drive, and stop the robot if nobody does: a flow has lost its publisher."""
        if not self.stop_controller.is_ready:
            return
        now = self._transport.now()
        self.pipeline.forget_flow(flow, now)
        self.stop_controller.forget_flow(flow, now)
        self._deadline_timer.run_due(now)
        self._notify_state_change()

    def limit(self, now: int) -> float | None:
        """Return the lowest limit (m/s) at `now`, None if there is none."""
        limits = (policy.limit(now) for policy in self.override_policies.values())
        return min((limit for limit in limits if limit is not None), default=None)

    def count_lost(self, flow: str, number: int) -> None:
        """Count messages of a flow that were lost before the guard."""
        self.losses.count(flow, number)

    @property
    def lost_behind(self) -> Mapping[str, int]:
        """How many messages that left the guard did not reach a subscriber, by topic."""
        return self.endpoints.outputs.lost

    def receive(self, flow: str, message: bytes) -> Verdict | None:
        """Let the pipeline decide about a message of a flow; None after an internal error."""
        now = self._transport.now()
        if self.dry_run:
            self.endpoints.outputs.send(flow, message)
        if self._brake_reasons:
            self.stop_controller.note_refused(flow, message, now)
        verdict = self._decide_safely(flow, message, now)
        if self.measurement:
            self.measurement.add_message(flow, message, now, verdict)
        if self.tap:
            self.tap.note_received(flow, message, now, verdict)
        decision = verdict.decision if verdict else _DROP
        if decision is _HOLD:
            self._deadline_timer.run_due(now)
        elif decision is _DROP and verdict and self.stop_controller.moving_flow:
            self._on_dropped(verdict, now)
        else:
            self._deadline_timer.ensure_armed()
        if (self.pipeline.owner, self.stop_controller.reason) != self._last_state:
            self._notify_state_change()
        if self.latencies:
            self.latencies.add(self._transport.now() - now)
        return verdict

    def _decide_safely(self, flow: str, message: bytes, now: int) -> Verdict | None:
        try:
            return self.pipeline.receive(flow, message, now)
        except MemoryError:
            exit_out_of_memory()
        except Exception:
            log.exception("%s: internal error, a message of %s is dropped", self.spec.topic, flow)
            self.stop_controller.refuse("internal error", now)
            self._deadline_timer.run_due(now)
            return None

    def _on_dropped(self, verdict: Verdict, now: int) -> None:
        """Stop the robot if a message of the flow that moves it is refused."""
        flow = self.stop_controller.moving_flow
        if flow and flow.name == verdict.flow:
            self.stop_controller.note_dropped(verdict, now)
            self.recheck(now)

    def _on_passed(self, flow: str, message: bytes, now: int) -> None:
        self.stop_controller.note_sent(flow, message, now)
        if self.measurement:
            self.measurement.add_passed(message, now)
        self._send_message(flow, message)
        if flow in self._rules_met:
            self._mission.mark_met(self._rules_met[flow])
        self._deadline_timer.rearm_if_earlier(self.stop_controller.deadline())

    def _send_message(self, flow: str, message: bytes) -> None:
        if self.tap:
            self.tap.note_sent(flow, message, self._transport.now())
        if not self.dry_run:
            self.endpoints.outputs.send(flow, message)

    def _next_deadline(self) -> int | None:
        pipeline_deadline, stop_deadline = self.pipeline.deadline(), self.stop_controller.deadline()
        return (
            pipeline_deadline
            if stop_deadline is None
            else stop_deadline
            if pipeline_deadline is None
            else min(pipeline_deadline, stop_deadline)
        )

    def _tick(self, now: int) -> None:
        self._slow_down(now)
        self.stop_controller.tick(now)
        try:
            self.pipeline.tick(now)
        except MemoryError:
            exit_out_of_memory()
        except Exception:
            log.exception("%s: internal error, held messages are lost", self.spec.topic)

    def _notify_state_change(self) -> None:
        state = (self.pipeline.owner, self.stop_controller.reason)
        if state != self._last_state:
            self._last_state = state
            if self.stop_controller.is_ready:
                self.store_order()
            self.on_state_change()
