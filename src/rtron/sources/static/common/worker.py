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

from rtron.executors.parent_process import follow_parent
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeInterface
from rtron.sources.static.common.task import InterpretationTask, TaskResult, run_task
from rtron.sources.workspace import indexed_workspace
from rtron.vocabulary import Evidence, UnresolvedItem

RECURSION_LIMIT = 20_000
GC_THRESHOLD = 200_000
"""New objects after which Python looks for cycles: most of ours live as long as the process."""
MAX_MEMORY = 8 * 2**30
_EXIT_PRIORITY = -1
"""Runs last when a process exits: its memory is freed as a whole, not object by object."""
GRACE_S = 10.0
"""How long (s) after its time limit a process that does not react to signals is ended."""

_SOURCES: dict[str, WorkspaceSources] = {}
_DEV_NULL = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - as long as the process


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
    gc.set_threshold(GC_THRESHOLD)
    with suppress(ValueError, OSError):  # the hard limit is lower already
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, hard))
    signal.signal(signal.SIGALRM, _time_up)
    follow_parent()
    Finalize(None, os._exit, args=(0,), exitpriority=_EXIT_PRIORITY)
    _SOURCES["workspace"] = WorkspaceSources(indexed_workspace(packages, folders))


def run_in_worker(task: InterpretationTask, seconds: float) -> TaskResult:
    """Return what a task's program declares, or a note that it took too long or failed."""
    try:
        with _time_limit(seconds):
            return run_task(task, _SOURCES["workspace"])
    except _TimeUpError:
        return failed_result(task, f"not done within {seconds:g} s")
    except RecursionError:
        return failed_result(task, "nested too deep")
    except MemoryError:
        return failed_result(task, "too large")
    except Exception as error:  # noqa: BLE001 - a fault of ours must not end the scan
        return failed_result(task, f"RTron failed at it: {type(error).__name__}: {error}")


def failed_result(task: InterpretationTask, why: str) -> TaskResult:
    """Return the result of a task that came to nothing."""
    places = tuple(Evidence(file=str(source)) for source in task.sources[:1])
    note = UnresolvedItem(what=f"the program of {task.site.name}", why=why, evidence=places)
    return TaskResult(interface=NodeInterface(unresolved=(note,)))


@contextmanager
def _time_limit(seconds: float) -> Iterator[None]:
    signal.setitimer(signal.ITIMER_REAL, seconds)
    faulthandler.dump_traceback_later(seconds + GRACE_S, exit=True, file=_DEV_NULL)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        faulthandler.cancel_dump_traceback_later()


def _time_up(*_: object) -> None:
    raise _TimeUpError
