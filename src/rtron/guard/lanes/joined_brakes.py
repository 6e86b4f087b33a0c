"""The brakes of all streams, those of the bulk process and those of the command process."""

from rtron.guard.audit.common.alarm_response import AuditBrakes, Brakes
from rtron.guard.lanes.command_lane import CommandLane


class JoinedBrakes:
    """See `Brakes`: the process that has no stream of a name does nothing about it."""

    def __init__(self, own: AuditBrakes, lane: CommandLane) -> None:
        self._brakes: tuple[Brakes, ...] = (own, lane)

    def hold(self, topic: str, why: str) -> None:
        """Let nothing of a stream pass and keep the robot stopped."""
        for brakes in self._brakes:
            brakes.hold(topic, why)

    def release(self, topic: str) -> None:
        """Let pass again what the policies let pass."""
        for brakes in self._brakes:
            brakes.release(topic)

    def repeat_stop(self, topic: str) -> None:
        """Tell a stop to a node that has just begun to listen."""
        for brakes in self._brakes:
            brakes.repeat_stop(topic)
