"""The emergency stop: nothing that moves the robot passes until it is taken back."""

import logging

from rtron.guard.core.coordinator import Host
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.stream import GuardedStream
from rtron.guard.settings.overrides import on_one_line
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import EmergencyStop, Mode, StreamKind

log = logging.getLogger(__name__)

_BY = "emergency stop"


class Emergency:
    """Brakes every enforced stream that can move the robot; in a dry run it only tells so."""

    def __init__(self, host: Host, transport: Transport) -> None:
        self._host = host
        self._stopped = [each for each in host.guarded if _moves(each)]
        # The first definition that is read takes a third of a second: not when there is no time.
        for guarded in self._stopped:
            standard_info(guarded.stream.type, transport.encoding)

    @property
    def stops(self) -> bool:
        """Whether there is anything that a stop keeps from moving the robot."""
        return bool(self._stopped)

    def stop(self, stop: EmergencyStop) -> None:
        """Stop the robot; nothing changes if it is stopped for this already."""
        why = _told(stop)
        if why == self._host.emergency:
            return
        self._host.emergency = why
        log.error("%s", why)
        for guarded in self._stopped:
            guarded.brake(_BY, why)

    def release(self) -> None:
        """Let pass again what nobody else keeps from passing."""
        if not self._host.emergency:
            return
        log.warning("no more: %s", self._host.emergency)
        self._host.emergency = ""
        for guarded in self._stopped:
            guarded.release(_BY)


def _moves(guarded: GuardedStream) -> bool:
    kind = guarded.stream.stages[0].settings.kind
    enforced = guarded.stream.mode is Mode.ENFORCE and not guarded.dry_run
    return enforced and (kind is not StreamKind.STATE or bool(guarded.stream.action))


def _told(stop: EmergencyStop) -> str:
    by, reason = on_one_line(stop.by), on_one_line(stop.reason)
    return f"{_BY} by {by}: {reason}" if reason else f"{_BY} by {by}"
