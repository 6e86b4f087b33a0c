"""The brake that the audit puts on a stream, and how it answers what intruders say there."""

from typing import TYPE_CHECKING, TypeAlias

from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from rtron.guard.lanes.command.remote_audit import RemoteBrake

_SOURCE = "the audit"
_ANSWER_PERIOD = SECOND // 1000


class AuditBrake:
    """Stops what a stream moves until `release`, and tells so for the plan's `repeat` after it.

    A node that begins to listen later is told too, while that stop is the stream's last word. What
    an intruder says meanwhile is answered with the stop.
    """

    def __init__(self, guarded: GuardedStream, transport: Transport) -> None:
        self._guarded = guarded
        self._transport = transport
        self._is_held = False
        self._repeat_until = 0
        self._stop_count: int | None = None
        self._next_answer = 0
        self._is_answer_due = False

    @property
    def is_ready(self) -> bool:
        """Whether the guard knows what stops the robot."""
        return self._guarded.stop_controller.is_ready

    def hold(self, why: str) -> None:
        """Let nothing pass and keep the robot stopped."""
        self._is_held = True
        self._brake(why)

    def release(self) -> None:
        """Let pass again what the policies let pass, which ends the stop; without it, go on."""
        self._is_held = False
        if self._guarded.stop_controller.is_ready:
            self._resume()
        else:
            self._guarded.release(_SOURCE)

    def answer(self, message: bytes) -> None:
        """Send the stop once more, at once, after a message of an intruder that moves the robot.

        At most 1,000 times a second; the last message is answered all the same. A stop needs no
        answer, so two guards do not answer each other.
        """
        if self._is_answer_due or not self._guarded.stop_controller.is_moving(message):
            return
        self._is_answer_due = True
        now = self._transport.now()
        if now >= self._next_answer:
            self._send_answer()
        else:
            self._transport.call_at(self._next_answer, self._send_answer)

    def _send_answer(self) -> None:
        now = self._transport.now()
        self._is_answer_due, self._next_answer = False, now + _ANSWER_PERIOD
        if self._is_held:
            self._guarded.stop_controller.repeat(now)

    def repeat_stop(self) -> None:
        """Tell the stop to a node that has just begun to listen, if nothing was said since."""
        if not self._is_held and self._is_last_message:
            self._brake("a node listens that may have missed the stop")
            self._resume()

    @property
    def _is_last_message(self) -> bool:
        stopper = self._guarded.stop_controller
        return (
            stopper.is_ready
            and stopper.moving_flow is None
            and self._stop_count == stopper.stop_count
        )

    def _brake(self, why: str) -> None:
        self._guarded.brake(_SOURCE, why)
        self._stop_count = self._guarded.stop_controller.stop_count

    def _resume(self) -> None:
        self._guarded.pipeline.unbar(_SOURCE)
        self._repeat_until = self._transport.now() + self._guarded.spec.stop.repeat
        self._transport.call_at(self._repeat_until, self._end)

    def _end(self) -> None:
        """Let the stop come to its end, unless there is a reason by now that it goes on."""
        if not self._is_held and self._transport.now() >= self._repeat_until:
            self._guarded.release(_SOURCE)


Brake: TypeAlias = "AuditBrake | RemoteBrake"
"""The brake of one stream, in this process or the other."""
