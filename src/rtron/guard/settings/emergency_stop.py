"""The emergency stop: nothing that moves the robot passes until it is taken back."""

import logging

from rtron.guard.core.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.stream import GuardedStream
from rtron.guard.settings.overrides import single_line
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import EmergencyStop, Mode, StreamKind

log = logging.getLogger(__name__)

_OWNER = "emergency stop"


class EmergencyBrake:
    """Brakes every enforced stream that can move the robot; in a dry run it only tells so."""

    def __init__(self, coordinator: Coordinator, transport: Transport) -> None:
        self._coordinator = coordinator
        self._streams = [each for each in coordinator.streams if _can_move_robot(each)]
        # The first definition that is read takes a third of a second: not when there is no time.
        for stream in self._streams:
            standard_info(stream.spec.type, transport.encoding)

    @property
    def has_effect(self) -> bool:
        """Whether there is anything that a stop keeps from moving the robot."""
        return bool(self._streams)

    def stop(self, stop: EmergencyStop) -> None:
        """Stop the robot; nothing changes if it is stopped for this already."""
        why = _stop_reason(stop)
        if why == self._coordinator.emergency:
            return
        self._coordinator.emergency = why
        log.error("%s", why)
        for stream in self._streams:
            stream.brake(_OWNER, why)

    def release(self) -> None:
        """Let pass again what nobody else keeps from passing."""
        if not self._coordinator.emergency:
            return
        log.warning("no more: %s", self._coordinator.emergency)
        self._coordinator.emergency = ""
        for stream in self._streams:
            stream.release(_OWNER)


def _can_move_robot(stream: GuardedStream) -> bool:
    kind = stream.spec.stages[0].settings.kind
    enforced = stream.spec.mode is Mode.ENFORCE and not stream.dry_run
    return enforced and (kind is not StreamKind.STATE or bool(stream.spec.action))


def _stop_reason(stop: EmergencyStop) -> str:
    by, reason = single_line(stop.by), single_line(stop.reason)
    return f"{_OWNER} by {by}: {reason}" if reason else f"{_OWNER} by {by}"
