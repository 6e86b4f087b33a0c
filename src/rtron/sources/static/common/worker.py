"""A process that interprets programs, one after the other; it keeps what it has read."""

import faulthandler
import gc
import os
import resource
import signal
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from multiprocessing.util import Finalize
from pathlib import Path

from rtron.executors.parent_process import serve_parent
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import NodeInterface
from rtron.sources.static.common.task import Task, TaskResult, run_task
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence, Unresolved

RECURSION_LIMIT = 20_000
COLLECTED_AFTER = 200_000
"""New objects after which Python looks for cycles: most of ours live as long as the process."""
MAX_MEMORY = 8 * 2**30
_LAST = -1
"""Of all that is done at a process's end: its memory goes back whole, not object by object."""
GRACE = 10.0
"""Seconds after its time limit at which a process ends that does not even react to a signal."""

_FILES: dict[str, WorkspaceFiles] = {}
_NOWHERE = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - as long as the process


class _TimeUpError(BaseException):
    """Raised in the middle of whatever runs too long; nothing but the worker catches it."""


@contextmanager
def deep_recursion() -> Iterator[None]:
    """Let this process recurse as deep as a worker does, for a while."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(RECURSION_LIMIT)
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


def start_worker(packages: Mapping[str, Path], folders: tuple[Path, ...]) -> None:
    """Make this process ready to work on a workspace."""
    sys.setrecursionlimit(RECURSION_LIMIT)
    gc.set_threshold(COLLECTED_AFTER)
    with suppress(ValueError, OSError):
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, hard))
    signal.signal(signal.SIGALRM, _time_up)
    serve_parent()
    Finalize(None, os._exit, args=(0,), exitpriority=_LAST)
    _FILES["workspace"] = WorkspaceFiles(Workspace(packages, folders))


def work(task: Task, seconds: float) -> TaskResult:
    """Return what a task's program declares, or a note that it took too long or failed."""
    try:
        with _limited(seconds):
            return run_task(task, _FILES["workspace"])
    except _TimeUpError:
        return failed(task, f"not done within {seconds:g} s")
    except RecursionError:
        return failed(task, "nested too deep")
    except MemoryError:
        return failed(task, "too large")
    except Exception as error:  # noqa: BLE001 - a fault of ours must not end the scan
        return failed(task, f"RTron failed at it: {type(error).__name__}: {error}")


def failed(task: Task, why: str) -> TaskResult:
    """Return the result of a task that came to nothing."""
    places = tuple(Evidence(file=str(source)) for source in task.sources[:1])
    note = Unresolved(what=f"the program of {task.site.name}", why=why, evidence=places)
    return TaskResult(interface=NodeInterface(unresolved=(note,)))


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    signal.setitimer(signal.ITIMER_REAL, seconds)
    faulthandler.dump_traceback_later(seconds + GRACE, exit=True, file=_NOWHERE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        faulthandler.cancel_dump_traceback_later()


def _time_up(*_: object) -> None:
    raise _TimeUpError
