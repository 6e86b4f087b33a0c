"""What the system knows of this process: its name, how urgent it is, and what else ends it."""

import ctypes
import logging
import os
import signal
from contextlib import suppress
from pathlib import Path

log = logging.getLogger(__name__)

_PR_SET_PDEATHSIG = 1
_prctl = ctypes.CDLL(None, use_errno=True).prctl


def set_process_name(name: str) -> None:
    """Let `ps -o comm` and `top` tell the processes apart: 15 characters (proc(5))."""
    with suppress(OSError):
        Path("/proc/self/comm").write_text(name)


def lower_priority(nice: int) -> None:
    """Let other processes go first (sched(7), SCHED_BATCH); go on where the system forbids it."""
    try:
        os.nice(nice)
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    except OSError as error:
        log.info("this process keeps its priority: %s", error)


def end_with_parent(parent: int) -> None:
    """Be killed when the parent ends, however that ends (prctl(2)); end if it has already.

    SIGKILL ends a process that is stopped, too.
    """
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def outlive_parent() -> None:
    """Take `end_with_parent` back."""
    _prctl(_PR_SET_PDEATHSIG, 0)
