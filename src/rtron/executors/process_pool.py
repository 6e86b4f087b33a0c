"""Runs items in several processes of this machine."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

from rtron.executors.base import Item, ItemFailure, Result
from rtron.executors.chunked_map import CHUNK_SIZE, LostWorkerError, map_in_order
from rtron.executors.parent_process import follow_parent, without_ctrl_c


@dataclass(frozen=True, slots=True)
class ProcessExecutor:
    """An Executor of `process_count` processes; they are started for each map and end with it."""

    process_count: int
    chunk_size: int = CHUNK_SIZE

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[Result | ItemFailure]:
        """Yield each item's result, as Executor says."""
        with closing(_ProcessPool(self.process_count)) as pool:
            yield from map_in_order(pool, function, items, self.chunk_size)


class _ProcessPool:
    """Processes that are started anew where one of them has ended."""

    def __init__(self, count: int) -> None:
        self.count = count
        self._executor: ProcessPoolExecutor | None = None

    def submit(self, function: Callable[..., Any], *arguments: object) -> Callable[[], Any]:
        """Begin a call; the answer waits for its result."""
        try:
            future = self._submit(function, *arguments)
        except BrokenProcessPool:
            self.close()
            future = self._submit(function, *arguments)
        return lambda: self._result(future)

    def _submit(self, function: Callable[..., Any], *arguments: object) -> "Future[Any]":
        with without_ctrl_c():
            return self._running_executor().submit(function, *arguments)

    def close(self) -> None:
        """End the processes."""
        if self._executor is not None:
            self._executor.shutdown(cancel_futures=True)
            self._executor = None

    def _result(self, future: "Future[Any]") -> Any:  # noqa: ANN401 - as the function's
        try:
            return future.result()
        except BrokenProcessPool:
            raise LostWorkerError from None

    def _running_executor(self) -> ProcessPoolExecutor:
        if self._executor is None:
            self._executor = ProcessPoolExecutor(
                max_workers=self.count, mp_context=get_context("spawn"), initializer=follow_parent
            )
        return self._executor
