"""A process that interprets programs, one after the other; it keeps what it has read."""

import faulthandler
import gc
import os
import resource
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.util import Finalize
from pathlib import Path
from typing import ParamSpec, TypeVar

from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeInterface
from rtron.sources.static.common.parent_process import follow_parent
from rtron.sources.static.common.task import InterpretationTask, TaskResult, run_task
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence, UnresolvedCause, UnresolvedItem

RECURSION_LIMIT = 20_000
GC_THRESHOLD = 200_000
"""New objects after which Python looks for cycles: most of ours live as long as the process."""
FRAME_SPACE = 2**17
"""Words of memory that a task reserves for its frames, twice: untouched ones cost nothing."""
MAX_MEMORY = 8 * 2**30
_EXIT_PRIORITY = -1
"""Runs last when a process exits: its memory is freed as a whole, not object by object."""
MAX_WAIT = 10
"""How many times its limit of processor time a task may last: a loaded machine gives less."""
GRACE_S = 10.0
"""How long (s) after that a process that does not react to signals is ended."""

_P = ParamSpec("_P")
_T = TypeVar("_T")
_SOURCES: dict[str, WorkspaceSources] = {}
_DEV_NULL = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - as long as the process


class TimeUpError(BaseException):
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


def start_worker(workspace: Workspace) -> None:
    """Make this process ready to work on a workspace; what a fork was given it leaves alone."""
    sys.setrecursionlimit(RECURSION_LIMIT)
    gc.freeze()
    gc.set_threshold(GC_THRESHOLD)
    with suppress(ValueError, OSError):  # the hard limit is lower already
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, hard))
    follow_parent()
    Finalize(None, os._exit, args=(0,), exitpriority=_EXIT_PRIORITY)
    _SOURCES["workspace"] = WorkspaceSources(workspace)


def with_frame_space(run: Callable[_P, _T]) -> Callable[_P, _T]:
    """Make a function whose calls find their frames' memory ready.

    CPython 3.11 and later keep frames in chunks, each as large as its first frame needs, 16 KiB at
    least, and unmap a chunk with that frame: a call beyond a chunk's end maps memory every time.
    """
    code = run.__code__
    run.__code__ = code.replace(co_stacksize=FRAME_SPACE)
    return run


@with_frame_space
def run_in_worker(task: InterpretationTask, seconds: float) -> TaskResult:
    """Return what a task's program declares, or a note that it took too long or failed."""
    try:
        with processor_time_limit(seconds):
            return run_task(task, _SOURCES["workspace"])
    except TimeUpError:
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
    what, cause = f"the program of {task.site.name}", UnresolvedCause.PARTLY_READ
    note = UnresolvedItem(what=what, why=why, cause=cause, evidence=places)
    return TaskResult(interface=NodeInterface(unresolved=(note,)))


@contextmanager
def processor_time_limit(seconds: float) -> Iterator[None]:
    """End what takes too long, so that a loaded machine finds what an idle one does."""
    for timer, signal_number, limit in (
        (signal.ITIMER_PROF, signal.SIGPROF, seconds),
        (signal.ITIMER_REAL, signal.SIGALRM, seconds * MAX_WAIT),
    ):
        signal.signal(signal_number, _time_up)
        signal.setitimer(timer, limit)
    faulthandler.dump_traceback_later(seconds * MAX_WAIT + GRACE_S, exit=True, file=_DEV_NULL)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        faulthandler.cancel_dump_traceback_later()


def _time_up(*_: object) -> None:
    raise TimeUpError
