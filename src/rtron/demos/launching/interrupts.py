"""^C and SIGTERM: both end the demo in order, and neither ends the ending."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_ENDING = (signal.SIGINT, signal.SIGTERM)
_Handler = Callable[[int, FrameType | None], Any] | int | None


@contextmanager
def heard() -> Iterator[None]:
    """Let both raise KeyboardInterrupt within the block, also where a shell had them ignored."""
    with _handled(signal.default_int_handler):
        yield


@contextmanager
def deferred() -> Iterator[None]:
    """Let neither interrupt the block; one that comes counts when the block is over."""
    came: list[int] = []
    try:
        with _handled(lambda number, _: came.append(number)):
            yield
    finally:
        for number in came[:1]:
            signal.raise_signal(number)


@contextmanager
def _handled(handler: _Handler) -> Iterator[None]:
    with _held_back():
        before = {number: signal.signal(number, handler) for number in _ENDING}
    try:
        yield
    finally:
        with _held_back():
            for number, old in before.items():
                signal.signal(number, old)


@contextmanager
def _held_back() -> Iterator[None]:
    """Let both wait until the block is over, so that no handler is left half way."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _ENDING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
