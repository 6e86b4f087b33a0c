"""Overrides in the settings: granted until their end, or until the settings drop them."""

import logging
from collections.abc import Iterator, Mapping

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.override_policy import OverridablePolicy, Override
from rtron.guard.settings.local_overrides import MAX_DURATION, single_line
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND, TimedOverride

log = logging.getLogger(__name__)

_CHANNEL = "settings"


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
