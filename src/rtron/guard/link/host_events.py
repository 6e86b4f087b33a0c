"""What happens in the guard, as events: who is in control, what is refused and why, alarms, rules.

A verdict is told when it differs from the one before on its flow; those that repeat are counted.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from typing import Any

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.stream import GuardedStream
from rtron.guard.link.event_recorder import RecordEvent
from rtron.guard.link.stream_monitor import StreamMonitor
from rtron.policies.mission.rule_status import RuleStatus
from rtron.vocabulary import (
    Alarm,
    CoordinationKind,
    Decision,
    EventKind,
    GuardEventLevel,
    PolicyName,
    Stage,
    Stream,
    Verdict,
)

_RSRCN = (PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN)


def stage_of(stream: Stream, verdict: Verdict) -> str:
    """Return the id of the stage that gave a verdict."""
    stages = (stage.id for stage in stream.stages if _is_from(stage, verdict))
    return next(stages, stream.stages[0].id)


def _is_from(stage: Stage, verdict: Verdict) -> bool:
    if verdict.policy in _RSRCN:
        return stage.coordination_kind is CoordinationKind.RSRCN
    if verdict.policy is not PolicyName.BLOCK:
        return stage.coordination_kind is CoordinationKind.GRCN
    if verdict.reason.startswith("rule "):
        return stage.coordination_kind is CoordinationKind.MSRCN
    return any(flow.name == verdict.flow and flow.block for flow in stage.settings.flows)


_LEVELS = {Decision.DROP: GuardEventLevel.WARNING, Decision.MODIFY: GuardEventLevel.WARNING}


class HostEvents:
    """Records what a host and its streams do as events, from `start` on."""

    def __init__(self, host: Coordinator, record: RecordEvent) -> None:
        self.stream_monitors: dict[str, StreamMonitor] = {}
        self.on_change: Callable[[], None] = lambda: None
        self._host = host
        self._record = record

    def start(self) -> None:
        """Listen to streams and rules; the host is open."""
        for guarded in self._host.streams:
            monitor = StreamMonitor(guarded)
            self.stream_monitors[f"{guarded.spec.mode} {guarded.spec.topic}"] = monitor
            guarded.pipeline.on_verdict_change = partial(self._record_verdict, guarded)
            self._observe_owner(guarded)
        mission = self._host.observations.mission
        mission.on_change = partial(self._record_rule, mission.on_change)
        self._host.intrusions.on_clear = self._record_clearing

    def listen_to_alarms(self) -> None:
        """Record the host's alarms, too, first those that stand already."""
        self._host.alarms.listener = self._record_alarm
        for alarm in self._host.alarms.active:
            self._record_alarm(alarm, active=True)

    def _observe_owner(self, guarded: GuardedStream) -> None:
        before = guarded.on_state_change

        def record_owner() -> None:
            before()
            self._record_owner(guarded)

        guarded.on_state_change = record_owner

    def _record_owner(self, guarded: GuardedStream) -> None:
        stopping = guarded.stop_controller.reason
        owner = guarded.pipeline.owner or ""
        publishers = {flow.name: flow.publisher for flow in guarded.spec.flows}
        node = guarded.spec.stages[0].id
        self._record(
            EventKind.STOP if stopping else EventKind.OWNER,
            GuardEventLevel.WARNING if stopping else GuardEventLevel.INFO,
            node=node,
            topic=guarded.spec.topic,
            flow=owner,
            publisher=publishers.get(owner, ""),
            reason=stopping or guarded.lease_text or ("" if owner else "idle"),
        )
        self.on_change()

    def _record_verdict(self, guarded: GuardedStream, verdict: Verdict) -> None:
        publishers = {flow.name: flow.publisher for flow in guarded.spec.flows}
        level = (
            GuardEventLevel.ERROR
            if verdict.error
            else _LEVELS.get(verdict.decision, GuardEventLevel.INFO)
        )
        self._record(
            EventKind.VERDICT,
            level,
            node=stage_of(guarded.spec, verdict),
            topic=guarded.spec.topic,
            flow=verdict.flow,
            publisher=publishers.get(verdict.flow, ""),
            policy=verdict.policy,
            decision=verdict.decision,
            reason=verdict.reason,
            revision=verdict.revision,
        )

    def _record_rule(
        self, former_callback: Callable[[RuleStatus], None], status: RuleStatus
    ) -> None:
        former_callback(status)
        level = GuardEventLevel.WARNING if status.is_blocking else GuardEventLevel.INFO
        values = {"rule": status.rule.name, "blocks": status.is_blocking}
        node = self._host.observations.node
        self._record(EventKind.RULE, level, node=node, reason=status.reason, values=values)
        self.on_change()

    def _record_clearing(self, topic: str, by: str) -> None:
        reason = f"the intrusion was cleared {by}"
        self._record(EventKind.STOP, GuardEventLevel.WARNING, topic=topic, reason=reason)

    def _record_alarm(self, alarm: Alarm, *, active: bool) -> None:
        kind, level = EventKind.ALARM_CLEARED, GuardEventLevel.INFO
        if active:
            kind, level = EventKind.ALARM, GuardEventLevel.ERROR
        values: Mapping[str, Any] = asdict(alarm)
        self._record(kind, level, topic=alarm.topic, reason=alarm.reason, values=values)
        self.on_change()
