"""Runs tasks over several processes; one that dies costs its own task only."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context

from rtron.sources.static.common.scan_options import default_workers
from rtron.sources.static.common.task import Task, TaskResult
from rtron.sources.static.common.worker import failed, start_worker, work
from rtron.sources.workspace import Workspace


@dataclass(slots=True)
class Pool:
    """Processes that work on one workspace, one a core at most, started with the first task."""

    workspace: Workspace
    workers: int
    seconds: float
    _executor: ProcessPoolExecutor | None = None

    def run(self, tasks: Sequence[Task]) -> Iterator[tuple[Task, TaskResult]]:
        """Yield each task with its result, as they are done."""
        if not tasks:
            return
        suspects: list[Task] = []
        for task, future in self._submitted(tasks):
            result = _result(future)
            if result is None:
                suspects.append(task)
            else:
                yield task, result
        if suspects:
            self.close()
        for task in suspects:
            yield task, self._alone(task)

    def close(self) -> None:
        """End the processes."""
        if self._executor is not None:
            self._executor.shutdown(cancel_futures=True)
            self._executor = None

    def _submitted(self, tasks: Sequence[Task]) -> Iterator[tuple[Task, "Future[TaskResult]"]]:
        executor = self._started(min(self.workers, len(tasks), default_workers()))
        futures = {executor.submit(work, task, self.seconds): task for task in tasks}
        for future in as_completed(futures):
            yield futures[future], future

    def _alone(self, task: Task) -> TaskResult:
        """Run a task in a process of its own, since one of several ended theirs."""
        result = _result(self._started(1).submit(work, task, self.seconds))
        if result is None:
            self.close()
        return result or failed(task, "the process that interpreted it ended")

    def _started(self, workers: int) -> ProcessPoolExecutor:
        if self._executor is None:
            self._executor = ProcessPoolExecutor(
                max_workers=max(1, workers),
                mp_context=get_context("spawn"),
                initializer=start_worker,
                initargs=(self.workspace.packages, self.workspace.folders),
            )
        return self._executor


def _result(future: "Future[TaskResult]") -> TaskResult | None:
    try:
        return future.result()
    except BrokenProcessPool:
        return None
