"""Overrides that settings hold: granted until their time has come, and taken back with them."""

import logging
from collections.abc import Iterator, Mapping

from rtron.guard.core.coordinator import Host
from rtron.guard.core.override_policy import Overridable, Override
from rtron.guard.settings.overrides import LONGEST, on_one_line
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND, TimedOverride

log = logging.getLogger(__name__)

_WAY = "settings"


class Granted:
    """The overrides of the settings in force; those asked for on the robot stand beside them."""

    def __init__(self, host: Host, transport: Transport) -> None:
        self._host = host
        self._transport = transport
        self._granted: Mapping[str, TimedOverride] = {}

    def put(self, overrides: Mapping[str, TimedOverride], wall_now: int) -> None:
        """Grant these, and end all others; `wall_now` is the wall clock, ns.

        No override lasts longer than one that is asked for on the robot.
        """
        before, self._granted = self._granted, dict(overrides)
        for id in before.keys() - overrides.keys():
            self._end(id)
        for id, override in overrides.items():
            if override != before.get(id):
                self._begin(id, override, override.until - wall_now)

    def _begin(self, id: str, override: TimedOverride, left: int) -> None:
        if left <= 0:
            self._end(id)
            return
        until = self._transport.now() + min(left, LONGEST)
        by, reason = on_one_line(override.by), on_one_line(override.reason)
        for policy in self._policies(id):
            policy.grant(_WAY, Override(by, reason, until))
        self._transport.call_at(until, self._host.attend)
        log.warning("%s: overridden by %s for %.1f s: %s", id, by, left / SECOND, reason)

    def _end(self, id: str) -> None:
        for policy in self._policies(id):
            policy.end(_WAY, self._transport.now())

    def _policies(self, id: str) -> Iterator[Overridable]:
        for guarded in self._host.guarded:
            if id in guarded.overridable:
                yield guarded.overridable[id]
