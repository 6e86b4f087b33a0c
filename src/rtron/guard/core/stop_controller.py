"""The stop of one velocity stream: messages of its type that bring the robot to rest."""

from collections.abc import Callable

from rtron.errors import WireError
from rtron.messages.common.velocity import VelocityCodec
from rtron.policies.velocity_watchdog import VelocityWatchdog
from rtron.vocabulary import (
    UNAPPROVED,
    Flow,
    Mode,
    OnError,
    Stream,
    StreamKind,
    Velocity,
    Verdict,
)

Send = Callable[[str, bytes], None]
"""Takes the flow that the guard speaks for, and the message."""


class StopController(VelocityWatchdog):
    """Stops the robot that a velocity stream moves; idle on other streams, and before `learn`."""

    def __init__(self, stream: Stream, send: Send) -> None:
        super().__init__(stream.stop, self._last_velocity)
        stranger = Flow(name=UNAPPROVED, publisher="*")
        self._flows = {flow.name: flow for flow in (stranger, *stream.flows)}
        commands = stream.stages[0].settings.kind is StreamKind.COMMAND
        self._is_enabled = commands and stream.mode is Mode.ENFORCE
        self._send = send
        self._codec: VelocityCodec | None = None
        self._last_message = b""
        self._refused: dict[str, tuple[bytes, int]] = {}
        self.on_slowed: Callable[[Velocity, int], None] = _ignore_slowed
        """Called with each velocity that is sent to slow or stop the robot, and the time."""

    def learn(self, codec: VelocityCodec) -> None:
        """Take the codec of the stream's messages."""
        if self._is_enabled and not codec.is_limit:
            self._codec = codec

    @property
    def is_ready(self) -> bool:
        """Whether the codec of the stream's messages is known."""
        return self._codec is not None

    @property
    def speed(self) -> float | None:
        """The last speed (m/s) that went out; None before, and where the stream moves nothing."""
        velocity = self._last_velocity() if self._last_message else None
        return velocity.speed if velocity else None

    def note_sent(self, flow: str, message: bytes, now: int) -> None:
        """Note that a message of `moving_flow` went out."""
        if self._codec is not None:
            self._last_message = message
            self.record_output(self._flows[flow], now)

    def note_dropped(self, verdict: Verdict, now: int) -> None:
        """Stop the robot if a message of the flow that moves it cannot be read."""
        flow = self.moving_flow
        if verdict.error and flow and flow.name == verdict.flow and flow.on_error is OnError.STOP:
            self.refuse(verdict.reason, now)

    def note_refused(self, flow: str, message: bytes, now: int) -> None:
        """Note what a flow says while the robot is kept stopped."""
        self._refused[flow] = message, now

    def moving_input(self, now: int) -> str:
        """Return a planned publisher that has just said something else than to stand still."""
        for name, (message, at) in self._refused.items():
            flow = self._flows[name]
            is_fresh = name != UNAPPROVED and now - at < flow.silent_after
            if is_fresh and self.is_moving(message):
                return flow.publisher
        return ""

    def slow_down(self, bounded: Callable[[Velocity, int], Velocity], now: int) -> None:
        """Repeat the last command as `bounded` changes it, if it does.

        A flow that has released the output may have stopped the robot: it is stopped, not set in
        motion again.
        """
        velocity = self._last_velocity()
        slower = bounded(velocity, now) if velocity else None
        if self._codec is None or slower is None or slower is velocity:
            return
        if self.is_released:
            self.refuse(f"the limit has fallen to {slower.speed:g} m/s", now)
            return
        self._last_message = self._codec.encode(self._last_message, slower)
        self.on_slowed(slower, now)
        self._send(self.last_flow, self._last_message)

    def brake(self, why: str, now: int) -> None:
        """Stop the robot until `release_brake`; do nothing if this stream moves none."""
        if self._codec is not None:
            super().brake(why, now)

    def tick(self, now: int) -> None:
        """Send the stop message that is due."""
        velocity = super().tick(now)
        if velocity is not None and self._codec is not None:
            self.on_slowed(velocity, now)
            self._send_stop(self._encode(self._codec, velocity))

    def repeat(self, now: int) -> None:
        """Send the stop message of this moment once more, if a stop is under way."""
        message = self.stop_message(now)
        if message is not None:
            self._send_stop(message)

    def stop_message(self, now: int) -> bytes | None:
        """Return the stop message of this moment, None if no stop is under way."""
        velocity = self.current(now)
        if velocity is None or self._codec is None:
            return None
        return self._encode(self._codec, velocity)

    def is_moving(self, message: bytes) -> bool:
        """Return whether a message sets the robot in motion; one that nobody can read may."""
        try:
            return self._codec is None or self._codec.decode(message).is_moving
        except WireError:
            return True

    def _encode(self, codec: VelocityCodec, velocity: Velocity) -> bytes:
        is_rest = not velocity.linear
        return codec.zero_message if is_rest else codec.encode(self._last_message, velocity)

    def _send_stop(self, message: bytes) -> None:
        self._send(self.last_flow or UNAPPROVED, message)

    def _last_velocity(self) -> Velocity | None:
        if self._codec is None:
            return None
        try:
            velocity = self._codec.decode(self._last_message)
        except WireError:
            return None
        return velocity if velocity.is_finite else None


def _ignore_slowed(_velocity: Velocity, _now: int) -> None:
    """Do nothing about a velocity that slows the robot."""
