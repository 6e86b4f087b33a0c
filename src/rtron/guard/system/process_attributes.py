"""What the system knows of this process: its name, how urgent it is, and what else ends it."""

import ctypes
import logging
import mmap
import os
import resource
import signal
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

log = logging.getLogger(__name__)

_PROBE_SIZE = 1 << 20
_LAST_WORDS = b"ERROR out of memory: the process ends\n"


def exit_out_of_memory() -> NoReturn:
    """End the process at once; nothing here needs memory."""
    os.write(2, _LAST_WORDS)
    os._exit(os.EX_OSERR)


def exit_if_out_of_memory() -> None:
    """End the process while it still can, if the system does not even give it 1 MiB."""
    try:
        mmap.mmap(-1, _PROBE_SIZE).close()
    except (OSError, MemoryError):
        exit_out_of_memory()


def allow_many_files() -> None:
    """Let this process open as many files as its hard limit allows: each connection is one."""
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


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
