"""Interprets programs in several processes; one that dies costs its own task only.

A worker takes one program after the other, and keeps what it has read.
"""

import faulthandler
import gc
import os
import resource
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.util import Finalize
from pathlib import Path
from typing import ParamSpec, TypeVar

from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeInterface
from rtron.sources.static.common.parent_process import follow_parent, without_ctrl_c
from rtron.sources.static.common.scan_options import default_workers
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
_PRIVATE_FORKSERVER = (3, 11, 1)
"""Before this Python, other users of the machine reach its fork server (CVE-2022-42919)."""


@dataclass(slots=True)
class WorkerPool:
    """Processes that work on one workspace, one a core at most, started with the first task.

    Forked ones have what this one has loaded and read; only a process without other threads can
    fork, since those might hold a lock. One with threads starts a server without any, once, which
    has loaded the code and forks for it. Without a `start_method` that decides.
    """

    workspace: Workspace
    workers: int
    seconds: float
    start_method: str | None = None
    _executor: ProcessPoolExecutor | None = None

    def run_tasks(
        self, tasks: Sequence[InterpretationTask]
    ) -> Iterator[tuple[InterpretationTask, TaskResult]]:
        """Yield each task with its result, as they are done."""
        if not tasks:
            return
        suspects: list[InterpretationTask] = []
        for task, future in self._submit(tasks):
            result = _result_or_none(future)
            if result is None:
                suspects.append(task)
            else:
                yield task, result
        if suspects:
            self.close()
        for task in suspects:
            yield task, self._run_isolated(task)

    def close(self) -> None:
        """End the processes."""
        if self._executor is not None:
            self._executor.shutdown(cancel_futures=True)
            self._executor = None

    def _submit(
        self, tasks: Sequence[InterpretationTask]
    ) -> Iterator[tuple[InterpretationTask, "Future[TaskResult]"]]:
        executor = self._start_executor(min(self.workers, len(tasks), default_workers()))
        with without_ctrl_c():
            futures = {executor.submit(run_in_worker, task, self.seconds): task for task in tasks}
        for future in as_completed(futures):
            yield futures[future], future

    def _run_isolated(self, task: InterpretationTask) -> TaskResult:
        """Run a task in a process of its own, since one of several ended theirs."""
        with without_ctrl_c():
            future = self._start_executor(1).submit(run_in_worker, task, self.seconds)
        result = _result_or_none(future)
        if result is None:
            self.close()
        return result or failed_result(task, "the process that interpreted it ended")

    def _start_executor(self, workers: int) -> ProcessPoolExecutor:
        if self._executor is None:
            method = self.start_method or _safe_start_method()
            context = get_context(method)
            if method == "forkserver":
                context.set_forkserver_preload([run_in_worker.__module__])
            fresh = Workspace(self.workspace.packages, self.workspace.folders)
            self._executor = ProcessPoolExecutor(
                max_workers=max(1, workers),
                mp_context=context,
                initializer=start_worker,
                initargs=(self.workspace if method == "fork" else fresh,),
            )
        return self._executor


def _safe_start_method() -> str:
    """Return how a process starts that needs nothing but what is here (`multiprocessing`)."""
    if sys.platform != "linux":
        return "spawn"
    if threading.active_count() == 1:
        return "fork"
    return "forkserver" if sys.version_info >= _PRIVATE_FORKSERVER else "spawn"


def _result_or_none(future: "Future[TaskResult]") -> TaskResult | None:
    try:
        return future.result()
    except BrokenProcessPool:
        return None


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
