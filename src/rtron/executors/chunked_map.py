"""Chunks of items on their way through workers, their results in order."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any, Protocol

from rtron.executors.base import Failed, Item, Result, attempt_all

CHUNK = 16
"""Items that go to a worker together: as many as make the way worth it, one if each is long."""
AHEAD = 3
"""Chunks that are on their way for each worker."""


class LostError(Exception):
    """The process that worked on a chunk ended, and with it the results."""


class Workers(Protocol):
    """Processes somewhere that work on chunks."""

    @property
    def count(self) -> int:
        """How many there are."""
        ...

    def submit(self, function: Callable[..., Any], *arguments: object) -> Callable[[], Any]:
        """Begin `function(*arguments)`; the answer waits for its result, or raises LostError."""
        ...


def in_order(
    workers: Workers, function: Callable[[Item], Result], items: Iterable[Item], chunk: int = CHUNK
) -> Iterator[Result | Failed]:
    """Yield each item's result in the items' order, with AHEAD chunks for each worker under way.

    The items of a chunk that was lost are tried one by one: only one that ends its process anew
    has failed.
    """
    under_way: deque[tuple[list[Item], Callable[[], Any]]] = deque()
    for part in _chunks(items, chunk):
        under_way.append((part, workers.submit(attempt_all, function, part)))
        if len(under_way) >= AHEAD * workers.count:
            yield from _results(workers, function, *under_way.popleft())
    while under_way:
        yield from _results(workers, function, *under_way.popleft())


def _chunks(items: Iterable[Item], size: int) -> Iterator[list[Item]]:
    iterator = iter(items)
    while chunk := list(islice(iterator, size)):
        yield chunk


def _results(
    workers: Workers,
    function: Callable[[Item], Result],
    chunk: list[Item],
    wait: Callable[[], list[Result | Failed]],
) -> Iterator[Result | Failed]:
    try:
        yield from wait()
    except LostError:
        for item in chunk:
            yield from _alone(workers, function, item)


def _alone(
    workers: Workers, function: Callable[[Item], Result], item: Item
) -> list[Result | Failed]:
    try:
        results: list[Result | Failed] = workers.submit(attempt_all, function, [item])()
    except LostError:
        return [Failed("the process that worked on it ended")]
    return results
