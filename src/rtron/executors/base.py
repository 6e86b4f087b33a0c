"""What runs a function on many items: here, in processes, or on a cluster."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Protocol, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class ItemFailure:
    """Stands for the result of an item at which the function failed, and says why."""

    reason: str


class MapExecutor(Protocol):
    """Runs one function on many items."""

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[Result | ItemFailure]:
        """Yield each item's result, in the items' order; Failed in the place of one that failed.

        Items are taken as they are needed, and a few results at most wait for their turn. The
        function must be one that another process can import.
        """


class UnorderedExecutor(Protocol):
    """Runs one function on many items, and does not keep a short one waiting for a long one."""

    def map_unordered(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[tuple[Item, Result | ItemFailure]]:
        """Yield each item with its result as soon as there is one, ItemFailure if it failed."""


def run_item(function: Callable[[Item], Result], item: Item) -> Result | ItemFailure:
    """Return a function's result, or that it failed."""
    try:
        return function(item)
    except RecursionError:
        return ItemFailure("nested too deep")
    except MemoryError:
        return ItemFailure("too large")
    except Exception as error:  # noqa: BLE001 - one item must not end the others
        return ItemFailure(f"{type(error).__name__}: {error}")


def run_items(
    function: Callable[[Item], Result], items: Sequence[Item]
) -> list[Result | ItemFailure]:
    """Return each item's result, or that the function failed at it."""
    return [run_item(function, item) for item in items]


class SerialExecutor:
    """An Executor that starts nothing."""

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[Result | ItemFailure]:
        """Yield each item's result, as Executor says."""
        return (run_item(function, item) for item in items)


@dataclass(frozen=True, slots=True)
class ThreadExecutor:
    """An UnorderedExecutor of threads, for a function that waits for other processes."""

    thread_count: int

    def map_unordered(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[tuple[Item, Result | ItemFailure]]:
        """Yield each item with its result; who stops earlier must end what is waited for."""
        pool = ThreadPoolExecutor(self.thread_count)
        try:
            futures = {pool.submit(run_item, function, item): item for item in items}
            for future in as_completed(futures):
                yield futures[future], future.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
