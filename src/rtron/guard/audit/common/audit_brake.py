"""The audit's brake of one stream: a stop that is told until whoever listens has heard it.

While an intruder is there, a node may have hung up on us: what we say then does not reach it, and
the last word that it has heard is the intruder's.
"""

from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Transport

_SOURCE = "the audit"


class AuditBrake:
    """Stops what a stream moves until `release`, and tells so for the plan's `repeat` after it.

    A node that begins to listen later is told too, while that stop is the stream's last word.
    """

    def __init__(self, guarded: GuardedStream, transport: Transport) -> None:
        self._guarded = guarded
        self._transport = transport
        self._is_held = False
        self._repeat_until = 0
        self._stop_count: int | None = None

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
