"""What a guard is at now, passed on a few times a second, whatever it says."""

import asyncio
from collections.abc import Callable

from pydantic import TypeAdapter

from rtron.errors import WireError
from rtron.service.collector.close_codes import CloseCode, CloseConnectionError
from rtron.vocabulary import GuardState, StreamState
from rtron.wire.common.link_protocol import StateDelta, StateReport
from rtron.wire.common.state_deltas import apply_state_delta

MIN_INTERVAL_S = 0.1
"""So long a state stands before the next one is passed on, s."""
MAX_STATE_BYTES = 256 << 10
"""The most bytes of a state."""
MAX_STATES_PER_SECOND = 100
"""So many states in a second end the connection; a guard tells a few."""
_WINDOW_S = 1.0
_STREAM = TypeAdapter(StreamState)


class StateThrottle:
    """Passes on the newest state with `update`, in the event loop; one for each connection."""

    def __init__(self, update: Callable[[GuardState], None]) -> None:
        self._update = update
        self._loop = asyncio.get_running_loop()
        self._newest: GuardState | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._window_start = self._loop.time()
        self._count = 0

    def put(self, state: GuardState, size: int) -> None:
        """Take a state that came in so many bytes; Closing if it is too large, or one too many."""
        if size > MAX_STATE_BYTES:
            raise CloseConnectionError(
                CloseCode.TOO_BIG, f"a state has at most {MAX_STATE_BYTES >> 10} KiB"
            )
        self._check_rate()
        self._newest = state
        if self._timer is None:
            self._forward()

    def stop(self) -> None:
        """Pass on nothing more."""
        if self._timer is not None:
            self._timer.cancel()

    def _check_rate(self) -> None:
        now = self._loop.time()
        if now - self._window_start >= _WINDOW_S:
            self._window_start, self._count = now, 0
        self._count += 1
        if self._count > MAX_STATES_PER_SECOND:
            raise CloseConnectionError(
                CloseCode.TOO_MUCH, f"more than {MAX_STATES_PER_SECOND} states in a second"
            )

    def _forward(self) -> None:
        self._timer = None
        if self._newest is not None:
            self._update(self._newest)
            self._newest = None
            self._timer = self._loop.call_later(MIN_INTERVAL_S, self._forward)


class DeltaBase:
    """The last state of a connection, to which deltas are applied; many small ones cannot swell it.

    Its size is at most that of the last whole state, of the streams since, and of the last delta.
    """

    def __init__(self) -> None:
        self._state: GuardState | None = None
        self._size = 0
        self._stream_sizes: dict[str, int] = {}

    def take(self, message: StateReport | StateDelta, size: int) -> GuardState:
        """Return the state that a message of so many bytes tells, whole or as a delta."""
        if isinstance(message, StateDelta):
            return self.apply(message, size)
        self.replace(message.state, size)
        return message.state

    def replace(self, state: GuardState, size: int) -> None:
        """Take a whole state that came in so many bytes."""
        self._state, self._size = state, size
        self._stream_sizes = {}

    def apply(self, delta: StateDelta, size: int) -> GuardState:
        """Return the next state; WireError if the delta does not fit, Closing if too large."""
        if self._state is None:
            raise WireError("a delta of the state comes before the state")
        for stream in delta.state.streams:
            self._stream_sizes[stream.topic] = len(_STREAM.dump_json(stream))
        if self._size + sum(self._stream_sizes.values()) + size > 2 * MAX_STATE_BYTES:
            limit = f"a state has at most {MAX_STATE_BYTES >> 10} KiB"
            raise CloseConnectionError(CloseCode.TOO_BIG, limit)
        self._state = apply_state_delta(self._state, delta)
        return self._state
