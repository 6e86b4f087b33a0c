"""New settings for the running guard: all of them at once, or none."""

import logging
from collections.abc import Callable, Iterator, Mapping

from rtron.coherence import EffectivePlan
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.override_policy import OverridablePolicy, Override
from rtron.guard.core.stream import GuardedStream
from rtron.guard.settings.local_overrides import MAX_DURATION, single_line
from rtron.guard.settings.mission_rules import MissionRules
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import (
    SECOND,
    EmergencyStop,
    Mode,
    Plan,
    Settings,
    StreamKind,
    TimedOverride,
    build_streams,
)

log = logging.getLogger(__name__)

_OWNER = "emergency stop"


class EmergencyBrake:
    """Brakes every enforced stream that can move the robot; a dry run only reports it."""

    def __init__(self, coordinator: Coordinator, transport: Transport) -> None:
        self._coordinator = coordinator
        self._streams = [each for each in coordinator.streams if can_move_robot(each)]
        # The first definition takes a third of a second to read: too long in an emergency.
        for stream in self._streams:
            standard_info(stream.spec.type, transport.encoding)

    @property
    def has_effect(self) -> bool:
        """Whether there is a stream that a stop can brake."""
        return bool(self._streams)

    def stop(self, stop: EmergencyStop) -> None:
        """Stop the robot; do nothing if it is stopped for the same reason already."""
        why = _stop_reason(stop)
        if why == self._coordinator.emergency:
            return
        self._coordinator.emergency = why
        for stream in self._streams:
            stream.brake(_OWNER, why)
        log.error("%s", why)

    def release(self) -> None:
        """Release the brakes of the emergency stop."""
        if not self._coordinator.emergency:
            return
        log.warning("released: %s", self._coordinator.emergency)
        self._coordinator.emergency = ""
        for stream in self._streams:
            stream.release(_OWNER)


def can_move_robot(stream: GuardedStream) -> bool:
    """Tell whether a stop can brake a stream: it is enforced, and no state."""
    kind = stream.spec.stages[0].settings.kind
    enforced = stream.spec.mode is Mode.ENFORCE and not stream.dry_run
    return enforced and (kind is not StreamKind.STATE or bool(stream.spec.action))


def _stop_reason(stop: EmergencyStop) -> str:
    by, reason = single_line(stop.by), single_line(stop.reason)
    return f"{_OWNER} by {by}: {reason}" if reason else f"{_OWNER} by {by}"


_CHANNEL = "settings"


class SettingsApplier:
    """Puts settings in force in a coordinator of `plan`, before it is opened or while it runs.

    Messages wait meanwhile. First it creates all that can fail; then the new parts replace the old
    ones and take over their state.
    """

    def __init__(
        self,
        plan: Plan,
        coordinator: Coordinator,
        transport: Transport,
        part: Callable[[Plan], Plan] = lambda plan: plan,
    ) -> None:
        """`part` returns what the coordinator carries of a plan."""
        self.revision = plan.revision
        """The revision in force."""
        self._plan, self._part = plan, part
        self._coordinator = coordinator
        self._transport = transport
        self._rules = MissionRules(part(plan), coordinator.observations)
        self._overrides = SettingsOverrides(coordinator, transport)
        self._emergency_stop = EmergencyBrake(coordinator, transport)

    @property
    def is_stopped(self) -> bool:
        """Whether the emergency stop keeps the robot from moving.

        In a dry run, and where the plan only observes, the stop is only reported.
        """
        return bool(self._coordinator.emergency) and self._emergency_stop.has_effect

    def apply(self, settings: Settings, machine_now: int) -> None:
        """Put settings in force; `machine_now` is the time (ns) that overrides end by.

        RTronError if they cannot be used; then nothing has changed.
        """
        plan = self._part(EffectivePlan(self._plan, settings).check())
        rules = self._rules.prepare(plan)
        pairs = zip(self._coordinator.streams, build_streams(plan), strict=True)
        adaptations = [
            each.prepare_update(stream, rules.observations, rules.rule_statuses)
            for each, stream in pairs
        ]
        now = self._transport.now()
        if settings.stop:
            self._emergency_stop.stop(settings.stop)
        self._rules.apply(rules, now)
        self._coordinator.apply_updates(rules.observations, adaptations)
        self._overrides.replace(settings.overrides, machine_now)
        self.revision = settings.revision
        if not settings.stop:
            self._emergency_stop.release()
        self._coordinator.recheck()


class SettingsOverrides:
    """The overrides of the settings in force; those requested on the robot are independent."""

    def __init__(self, coordinator: Coordinator, transport: Transport) -> None:
        self._coordinator = coordinator
        self._transport = transport
        self._overrides: Mapping[str, TimedOverride] = {}

    def replace(self, overrides: Mapping[str, TimedOverride], machine_now: int) -> None:
        """Grant these, and end all others; `machine_now` is the machine's time, ns.

        No override lasts longer than one that is requested on the robot.
        """
        before, self._overrides = self._overrides, dict(overrides)
        for id in before.keys() - overrides.keys():
            self._end(id)
        for id, override in overrides.items():
            if override != before.get(id):
                self._start(id, override, override.until - machine_now)

    def _start(self, id: str, override: TimedOverride, remaining: int) -> None:
        if remaining <= 0:
            self._end(id)
            return
        until = self._transport.now() + min(remaining, MAX_DURATION)
        by, reason = single_line(override.by), single_line(override.reason)
        for policy in self._policies(id):
            policy.grant(_CHANNEL, Override(by, reason, until))
        self._transport.call_at(until, self._coordinator.recheck)
        log.warning("%s: overridden by %s for %.1f s: %s", id, by, remaining / SECOND, reason)

    def _end(self, id: str) -> None:
        for policy in self._policies(id):
            policy.end_override(_CHANNEL, self._transport.now())

    def _policies(self, id: str) -> Iterator[OverridablePolicy]:
        for stream in self._coordinator.streams:
            if id in stream.override_policies:
                yield stream.override_policies[id]
