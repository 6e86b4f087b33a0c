"""Runs tasks over several processes; one that dies costs its own task only."""

import sys
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context

from rtron.sources.static.common.parent_process import without_ctrl_c
from rtron.sources.static.common.scan_options import default_workers
from rtron.sources.static.common.task import InterpretationTask, TaskResult
from rtron.sources.static.common.worker import failed_result, run_in_worker, start_worker
from rtron.sources.workspace import Workspace

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
