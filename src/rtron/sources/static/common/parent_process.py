"""A process that works for another lives no longer than that one."""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import parent_process
from pathlib import Path
from threading import Thread

_PROC_TASKS = Path("/proc/self/task")


def follow_parent() -> None:
    """Leave Ctrl-C to the process that started this one, and end as soon as that has ended.

    What this process has started itself ends with it, where the system tells what that is (Linux).
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()


@contextmanager
def without_ctrl_c() -> Iterator[None]:
    """Let processes start in the block that Ctrl-C does not reach before `follow_parent` is called.

    It reaches this process when the block ends.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        for child in _child_processes():
            with suppress(OSError):  # it has ended already
                os.kill(child, signal.SIGKILL)
        os._exit(1)


def _child_processes() -> Iterator[int]:
    for path in _PROC_TASKS.glob("*/children"):
        with suppress(OSError):  # that thread has ended
            yield from map(int, path.read_text().split())
