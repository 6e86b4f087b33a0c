"""The audit's brake of one stream: a stop that is told until whoever listens has heard it.

While an intruder is there, a node may have hung up on us: what we say then does not reach it, and
the last word that it has heard is the intruder's.
"""

from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Transport

_BY = "the audit"


class Brake:
    """Stops what a stream moves until `let_go`, and tells so for the plan's `repeat` after it.

    A node that begins to listen later is told too, while that stop is the stream's last word.
    """

    def __init__(self, guarded: GuardedStream, transport: Transport) -> None:
        self._guarded = guarded
        self._transport = transport
        self._holds = False
        self._until = 0
        self._stops: int | None = None

    def hold(self, why: str) -> None:
        """Let nothing pass and keep the robot stopped."""
        self._holds = True
        self._brake(why)

    def let_go(self) -> None:
        """Let pass again what the policies let pass, which ends the stop; without it, go on."""
        self._holds = False
        if self._guarded.stopper.knows:
            self._free()
        else:
            self._guarded.release(_BY)

    def listened(self) -> None:
        """Tell the stop to a node that has just begun to listen, if nothing was said since."""
        if not self._holds and self._is_last_word:
            self._brake("a node listens that may have missed the stop")
            self._free()

    @property
    def _is_last_word(self) -> bool:
        stopper = self._guarded.stopper
        return stopper.knows and stopper.moving is None and self._stops == stopper.stops

    def _brake(self, why: str) -> None:
        self._guarded.brake(_BY, why)
        self._stops = self._guarded.stopper.stops

    def _free(self) -> None:
        self._guarded.pipeline.free(_BY)
        self._until = self._transport.now() + self._guarded.stream.stop.repeat
        self._transport.call_at(self._until, self._end)

    def _end(self) -> None:
        """Let the stop come to its end, unless there is a reason by now that it goes on."""
        if not self._holds and self._transport.now() >= self._until:
            self._guarded.release(_BY)
