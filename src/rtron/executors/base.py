"""What runs a function on many items: here, in processes, or on a cluster."""

from collections.abc import Callable, Iterable, Iterator, Sequence
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
        ...


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
