"""The supervisor's connections to what moves the robot, and the stop that it sends there."""

import logging
from collections.abc import Callable

from rtron.guard.core.message_types import codec_of, standard_info
from rtron.guard.core.stop_controller import StopController
from rtron.guard.intrusion_latch import intrusions_in
from rtron.guard.supervision.shared_memory import (
    DoubleBuffer,
    GuardMemory,
    StatusWord,
    decode_last_message,
    decode_type_info,
)
from rtron.guard.transport.common.protocol import Output, OutputOptions, Transport, TypeInfo
from rtron.messages.common.velocity import VelocityCodec
from rtron.vocabulary import SUPERVISOR_NODE, UNAPPROVED, QoS, Stream, output_topic

log = logging.getLogger(__name__)


class StreamBrake:
    """One stream's outputs; every successor is connected before anything happens.

    Whoever obeys and is not a successor hears the public topic, as it hears the guard there.
    """

    def __init__(
        self, stream: Stream, transport: Transport, stopped: Callable[[], frozenset[str]]
    ) -> None:
        """Take what returns the streams that intruders have stopped."""
        self._stream = stream
        self._stopped = stopped
        self._transport = transport
        private = (output_topic(stream.topic),) if stream.successors else ()
        self._outputs = tuple(map(self._open, (*private, stream.topic)))
        self._codec: VelocityCodec | None = None
        self._type_count = 0
        self._stopper: StopController | None = None
        self._braking_since = 0

    def _open(self, topic: str) -> Output:
        options = OutputOptions(queue_size=self._stream.queue_size)
        output = self._transport.advertise(SUPERVISOR_NODE, topic, self._stream.type, options)
        output.match_subscribers(() if topic == self._stream.topic else self._stream.successors)
        output.offer(UNAPPROVED, QoS())
        output.greet(self._greeting)
        return output

    def prepare(self) -> None:
        """Read the type's standard definition, so that a stop does not wait for it."""
        standard_info(self._stream.type, self._transport.encoding)

    def learn_type(self, buffer: DoubleBuffer) -> None:
        """Take the type that the guard has learned, once it has: when it dies there is no time."""
        if buffer.write_count() == self._type_count:
            return
        self._type_count, data = buffer.read()
        info = decode_type_info(data)
        if info:
            self._codec = self._codec_of(info) or self._codec

    def forget_type(self) -> None:
        """Let another guard tell the type."""
        self._type_count = 0

    def brake(self, buffer: DoubleBuffer, last_beat: int, reason: str, now: int) -> None:
        """Stop the robot from the last message on, if it was in force when the guard was alive.

        Otherwise it may be at rest, and a ramp would set it in motion: it is told to rest.
        """
        codec = self._codec or self._standard()
        if self._stopper or codec is None:
            return
        self._braking_since, self._stopper = now, StopController(self._stream, self._send)
        self._stopper.learn(codec)
        last_message = decode_last_message(buffer.read()[1])
        if last_message.sent_at and last_message.valid_until >= last_beat:
            self._stopper.note_sent(UNAPPROVED, last_message.message, now)
        self._stopper.brake(reason, now)

    def release(self) -> None:
        """Let the stop come to its end."""
        if self._stopper:
            self._stopper.release_brake()

    def yield_to_guard(self, buffer: DoubleBuffer) -> None:
        """End the stop if the guard has said something since."""
        if self._stopper and decode_last_message(buffer.read()[1]).sent_at > self._braking_since:
            self._stopper = None

    def tick(self, now: int) -> bool:
        """Send what is due; tell whether the stop goes on."""
        if self._stopper:
            self._stopper.tick(now)
            if self._stopper.deadline() is None:
                self._stopper = None
        return self._stopper is not None

    def _greeting(self) -> bytes | None:
        """Return what a new subscriber hears first while the robot is to be at rest."""
        if self._stopper:
            return self._stopper.stop_message(self._transport.now())
        is_stopped = self._codec and self._stream.topic in self._stopped()
        return self._codec.zero_message if self._codec and is_stopped else None

    def _send(self, _flow: str, message: bytes) -> None:
        for output in self._outputs:
            output.publish(message)

    def _standard(self) -> VelocityCodec | None:
        """Return how the stream's velocities are written by the standard, if nobody has told."""
        info = standard_info(self._stream.type, self._transport.encoding)
        return self._codec_of(info) if info else None

    def _codec_of(self, info: TypeInfo) -> VelocityCodec | None:
        """Return how velocities of a type are written; None if it has none that are known."""
        codec = codec_of(info, self._transport.encoding)
        if codec is None or codec.is_limit:
            return None
        return codec if all(output.learn_type(info) for output in self._outputs) else None


class StreamBrakes:
    """The brakes of every stream that the guard in `memory` governs."""

    def __init__(
        self, streams: tuple[Stream, ...], transport: Transport, memory: GuardMemory
    ) -> None:
        self._memory = memory
        self._brakes = [StreamBrake(stream, transport, self._stopped) for stream in streams]
        self._is_released = True

    def prepare(self) -> None:
        """Read the standard types now: on ROS 2 that takes 0.4 s, and more on a busy machine."""
        for brake in self._brakes:
            brake.prepare()

    def follow(self, memory: GuardMemory) -> None:
        """Look at another guard from now on."""
        self._memory = memory
        for brake in self._brakes:
            brake.forget_type()

    def _stopped(self) -> frozenset[str]:
        return frozenset(intrusions_in(self._memory.handover_state.read()[1]))

    def brake(self, reason: str, now: int) -> None:
        """Stop the robot and keep it stopped."""
        self._is_released = False
        last_beat = self._memory[StatusWord.GUARD_BEAT]
        self._memory[StatusWord.STOPPED] = now
        for brake, buffer in zip(self._brakes, self._memory.last_messages, strict=True):
            brake.brake(buffer, last_beat, reason, now)
        self.tick(now)

    def release(self) -> None:
        """Let every stop come to its end; at once where the guard speaks."""
        self._is_released = True
        for brake in self._brakes:
            brake.release()

    def tick(self, now: int) -> bool:
        """Do what is due; tell whether a stop goes on."""
        buffers = zip(
            self._brakes, self._memory.type_infos, self._memory.last_messages, strict=True
        )
        for brake, info, last_message in buffers:
            brake.learn_type(info)
            if self._is_released:
                brake.yield_to_guard(last_message)
        ticked = [brake.tick(now) for brake in self._brakes]
        return any(ticked)
