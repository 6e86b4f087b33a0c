"""Chunks of items on their way through workers, their results in order."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any, Protocol

from rtron.executors.base import Item, ItemFailure, Result, run_items

CHUNK_SIZE = 16
"""Items that go to a worker together: as many as make the way worth it, one if each is long."""
CHUNKS_PER_WORKER = 3
"""Chunks that are on their way for each worker."""


class LostWorkerError(Exception):
    """The process that worked on a chunk ended, and with it the results."""


class ChunkWorkers(Protocol):
    """Processes somewhere that work on chunks."""

    @property
    def count(self) -> int:
        """How many there are."""

    def submit(self, function: Callable[..., Any], *arguments: object) -> Callable[[], Any]:
        """Begin `function(*arguments)`; the answer waits for its result.

        It raises LostWorkerError where the worker is gone.
        """


def map_in_order(
    workers: ChunkWorkers,
    function: Callable[[Item], Result],
    items: Iterable[Item],
    chunk_size: int = CHUNK_SIZE,
) -> Iterator[Result | ItemFailure]:
    """Yield each item's result in the items' order, with AHEAD chunks for each worker under way.

    The items of a chunk that was lost are tried one by one: only one that ends its process anew
    has failed.
    """
    pending: deque[tuple[list[Item], Callable[[], Any]]] = deque()
    for chunk_items in _chunks(items, chunk_size):
        pending.append((chunk_items, workers.submit(run_items, function, chunk_items)))
        if len(pending) >= CHUNKS_PER_WORKER * workers.count:
            yield from _chunk_results(workers, function, *pending.popleft())
    while pending:
        yield from _chunk_results(workers, function, *pending.popleft())


def _chunks(items: Iterable[Item], size: int) -> Iterator[list[Item]]:
    iterator = iter(items)
    while chunk := list(islice(iterator, size)):
        yield chunk


def _chunk_results(
    workers: ChunkWorkers,
    function: Callable[[Item], Result],
    chunk: list[Item],
    wait: Callable[[], list[Result | ItemFailure]],
) -> Iterator[Result | ItemFailure]:
    try:
        yield from wait()
    except LostWorkerError:
        for item in chunk:
            yield from _retry_item(workers, function, item)


def _retry_item(
    workers: ChunkWorkers, function: Callable[[Item], Result], item: Item
) -> list[Result | ItemFailure]:
    try:
        results: list[Result | ItemFailure] = workers.submit(run_items, function, [item])()
    except LostWorkerError:
        return [ItemFailure("the process that worked on it ended")]
    return results
