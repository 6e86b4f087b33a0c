"""Signals that end a program: each interrupts a block, or is held back until its end."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

_TERMINATION_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_STANDARD_ERROR = 2
_NOTICE = "\nending what was started…\n".encode()
_Handler = Callable[[int, FrameType | None], Any] | int | None


@contextmanager
def interrupt_on_signals() -> Iterator[None]:
    """Let each raise KeyboardInterrupt within the block, also where a shell had it ignored.

    It is said on standard error, since the end may take a while.

    Only a SIGHUP that is ignored stays so: that is what nohup is for.
    """
    with _install_handler(_interrupt):
        yield


@contextmanager
def defer_signals() -> Iterator[None]:
    """Let none interrupt the block; one that comes counts when the block is over."""
    pending: list[int] = []
    try:
        with _install_handler(lambda number, _: pending.append(number)):
            yield
    finally:
        for number in pending[:1]:
            signal.raise_signal(number)


def _interrupt(number: int, frame: FrameType | None) -> None:
    with suppress(OSError):  # a terminal that is closed
        os.write(_STANDARD_ERROR, _NOTICE)  # Python's own stream may be in the midst of a line
    signal.default_int_handler(number, frame)


@contextmanager
def _install_handler(handler: _Handler) -> Iterator[None]:
    with _block_signals():
        before = {number: signal.signal(number, handler) for number in _handled_signals()}
    try:
        yield
    finally:
        with _block_signals():
            for number, old in before.items():
                signal.signal(number, old)


def _handled_signals() -> Iterator[signal.Signals]:
    for number in _TERMINATION_SIGNALS:
        if number is not signal.SIGHUP or signal.getsignal(number) is not signal.SIG_IGN:
            yield number


@contextmanager
def _block_signals() -> Iterator[None]:
    """Let them wait until the block is over, so that no handler is left half way."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _TERMINATION_SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
