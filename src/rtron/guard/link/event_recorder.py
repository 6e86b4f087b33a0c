"""What happens in the guard, as events: who is in control, what is refused and why, alarms, rules.

A verdict is told when it differs from the one before on its flow; those that repeat are counted.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from typing import Any

from rtron.guard.core.coordinator import Host
from rtron.guard.core.stream import GuardedStream
from rtron.guard.link.event_counter import RunCounter
from rtron.guard.link.stream_monitor import StreamWatch
from rtron.guard.link.verdict_stage import stage_of
from rtron.policies.mission.rule_status import Standing
from rtron.vocabulary import (
    Alarm,
    Decision,
    EventKind,
    GuardEvent,
    Level,
    Verdict,
)

Tell = Callable[[GuardEvent], None]
_LONGEST = 300
_LEVELS = {Decision.DROP: Level.WARNING, Decision.MODIFY: Level.WARNING}


class Recorder:
    """Turns what a host and its streams do into events, from `watch` on.

    `has_place` tells whether one more can be kept: what finds no place is counted, and told as
    lost once there is place again.
    """

    def __init__(
        self,
        host: Host,
        counter: RunCounter,
        run: str,
        tell: Tell,
        has_place: Callable[[], bool],
        wall: Callable[[], int],
    ) -> None:
        self.watches: dict[str, StreamWatch] = {}
        self.changed: Callable[[], None] = lambda: None
        self.revision = 0
        self._host = host
        self._counter = counter
        self._run = run
        self._tell = tell
        self._has_place = has_place
        self._wall = wall
        self._lost = 0

    def watch(self) -> None:
        """Listen to everything; the host is open."""
        for guarded in self._host.guarded:
            watch = StreamWatch(guarded)
            self.watches[f"{guarded.stream.mode} {guarded.stream.topic}"] = watch
            guarded.pipeline.changed = partial(self._verdict, guarded)
            self._after_told(guarded)
        mission = self._host.senses.mission
        mission.changed = partial(self._rule, mission.changed)
        self._host.alarms.told = self._alarm
        for alarm in self._host.alarms.standing:
            self._alarm(alarm, stands=True)

    def record(self, kind: EventKind, level: Level = Level.INFO, **values: Any) -> None:  # noqa: ANN401
        """Tell an event; `values` are the fields of a GuardEvent."""
        if not self._has_place():
            self._lost += 1
            return
        if self._lost:
            self._tell_lost()
        self._make(kind, level, **values)

    def _tell_lost(self) -> None:
        count, self._lost = self._lost, 0
        reason = f"{count} events were lost: the link process was away for too long"
        self._make(EventKind.LOST, Level.WARNING, reason=reason, values={"events": count})

    def _make(self, kind: EventKind, level: Level, **values: Any) -> None:  # noqa: ANN401
        values["reason"] = str(values.get("reason", ""))[:_LONGEST]
        number = self._counter.next()
        values.setdefault("revision", self.revision)
        self._tell(
            GuardEvent(
                run=self._run, number=number, at=self._wall(), kind=kind, level=level, **values
            )
        )

    def _after_told(self, guarded: GuardedStream) -> None:
        before = guarded.told

        def told() -> None:
            before()
            self._owner(guarded)

        guarded.told = told

    def _owner(self, guarded: GuardedStream) -> None:
        stopping = guarded.stopper.why
        owner = guarded.pipeline.owner or ""
        publishers = {flow.name: flow.publisher for flow in guarded.stream.flows}
        node = guarded.stream.stages[0].id
        self.record(
            EventKind.STOP if stopping else EventKind.OWNER,
            Level.WARNING if stopping else Level.INFO,
            node=node,
            topic=guarded.stream.topic,
            flow=owner,
            publisher=publishers.get(owner, ""),
            reason=stopping or ("" if owner else "idle"),
        )
        self.changed()

    def _verdict(self, guarded: GuardedStream, verdict: Verdict) -> None:
        publishers = {flow.name: flow.publisher for flow in guarded.stream.flows}
        level = Level.ERROR if verdict.error else _LEVELS.get(verdict.decision, Level.INFO)
        self.record(
            EventKind.VERDICT,
            level,
            node=stage_of(guarded.stream, verdict),
            topic=guarded.stream.topic,
            flow=verdict.flow,
            publisher=publishers.get(verdict.flow, ""),
            policy=verdict.policy,
            decision=verdict.decision,
            reason=verdict.reason,
            revision=verdict.revision,
        )

    def _rule(self, before: Callable[[Standing], None], standing: Standing) -> None:
        before(standing)
        level = Level.WARNING if standing.blocks else Level.INFO
        values = {"rule": standing.rule.name, "blocks": standing.blocks}
        node = self._host.senses.node
        self.record(EventKind.RULE, level, node=node, reason=standing.reason, values=values)
        self.changed()

    def _alarm(self, alarm: Alarm, *, stands: bool) -> None:
        kind, level = EventKind.SETTLED, Level.INFO
        if stands:
            kind, level = EventKind.ALARM, Level.ERROR
        values: Mapping[str, Any] = asdict(alarm)
        self.record(kind, level, topic=alarm.topic, reason=alarm.reason, values=values)
        self.changed()
