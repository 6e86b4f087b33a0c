"""The supervisor's connections to what moves the robot, and the stop that it sends there."""

import logging

from rtron.guard.core.message_types import codec_of, standard_info
from rtron.guard.core.stop_controller import Stopper
from rtron.guard.supervision.last_message import info_of, said_of
from rtron.guard.supervision.shared_memory import Cell, Field, Page
from rtron.guard.transport.common.protocol import Output, Transport, TypeInfo
from rtron.messages.common.velocity import VelocityCodec
from rtron.vocabulary import SUPERVISOR_NODE, UNAPPROVED, QoS, Stream, output_topic

log = logging.getLogger(__name__)


class Brake:
    """One stream's private output; every successor is connected before anything happens."""

    def __init__(self, stream: Stream, transport: Transport) -> None:
        self._stream = stream
        self._transport = transport
        self._output: Output = transport.advertise(
            SUPERVISOR_NODE, output_topic(stream.topic), stream.type, queue_size=stream.queue_size
        )
        self._output.suit(stream.successors)
        self._output.offer(UNAPPROVED, QoS())
        self._codec: VelocityCodec | None = None
        self._learned = 0
        self._stopper: Stopper | None = None
        self._since = 0

    def learn(self, cell: Cell) -> None:
        """Take the type that the guard has learned, once it has: when it dies there is no time."""
        if cell.count() == self._learned:
            return
        self._learned, data = cell.read()
        info = info_of(data)
        if info:
            self._codec = self._codec_of(info) or self._codec

    def forget_guard(self) -> None:
        """Let another guard tell the type."""
        self._learned = 0

    def brake(self, cell: Cell, alive: int, why: str, now: int) -> None:
        """Stop the robot from the last message on, if it was in force when the guard was alive.

        Otherwise it may be at rest, and a ramp would set it in motion: it is told to rest.
        """
        codec = self._codec or self._standard()
        if self._stopper or codec is None:
            return
        self._since, self._stopper = now, Stopper(self._stream, self._send)
        self._stopper.learn(codec)
        said = said_of(cell.read()[1])
        if said.at and said.until >= alive:
            self._stopper.said(UNAPPROVED, said.message, now)
        self._stopper.brake(why, now)

    def loosen(self) -> None:
        """Let the stop come to its end."""
        if self._stopper:
            self._stopper.loosen()

    def yield_to(self, cell: Cell) -> None:
        """End the stop if the guard has said something since."""
        if self._stopper and said_of(cell.read()[1]).at > self._since:
            self._stopper = None

    def tick(self, now: int) -> bool:
        """Send what is due; tell whether the stop goes on."""
        if self._stopper:
            self._stopper.tick(now)
            if self._stopper.deadline() is None:
                self._stopper = None
        return self._stopper is not None

    def _send(self, _flow: str, message: bytes) -> None:
        self._output.publish(message)

    def _standard(self) -> VelocityCodec | None:
        """Return how the stream's velocities are written by the standard, if nobody has told."""
        info = standard_info(self._stream.type, self._transport.encoding)
        return self._codec_of(info) if info else None

    def _codec_of(self, info: TypeInfo) -> VelocityCodec | None:
        """Return how velocities of a type are written; None if it has none that are known."""
        codec = codec_of(info, self._transport.encoding)
        known = codec is not None and not codec.is_limit and self._output.learn(info)
        return codec if known else None


class Brakes:
    """The brakes of every stream that the guard in `page` governs."""

    def __init__(self, streams: tuple[Stream, ...], transport: Transport, page: Page) -> None:
        self._brakes = [Brake(stream, transport) for stream in streams]
        self._page = page
        self._loose = True

    def follow(self, page: Page) -> None:
        """Look at another guard from now on."""
        self._page = page
        for brake in self._brakes:
            brake.forget_guard()

    def brake(self, why: str, now: int) -> None:
        """Stop the robot and keep it stopped."""
        self._loose = False
        alive = self._page[Field.GUARD_BEAT]
        self._page[Field.STOPPED] = now
        for brake, cell in zip(self._brakes, self._page.said, strict=True):
            brake.brake(cell, alive, why, now)
        self.tick(now)

    def loosen(self) -> None:
        """Let every stop come to its end; at once where the guard speaks."""
        self._loose = True
        for brake in self._brakes:
            brake.loosen()

    def tick(self, now: int) -> bool:
        """Do what is due; tell whether a stop goes on."""
        cells = zip(self._brakes, self._page.infos, self._page.said, strict=True)
        for brake, info, said in cells:
            brake.learn(info)
            if self._loose:
                brake.yield_to(said)
        ticked = [brake.tick(now) for brake in self._brakes]
        return any(ticked)
