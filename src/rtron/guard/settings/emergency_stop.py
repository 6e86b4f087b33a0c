"""The emergency stop: no message that moves the robot passes until it is released."""

import logging

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.stream import GuardedStream
from rtron.guard.settings.local_overrides import single_line
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import EmergencyStop, Mode, StreamKind

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
