"""What runs a function on many items: here, in processes, or on a cluster."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class Failed:
    """Stands for the result of an item at which the function failed, and says why."""

    why: str


class Executor(Protocol):
    """Runs one function on many items."""

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[Result | Failed]:
        """Yield each item's result, in the items' order; Failed in the place of one that failed.

        Items are taken as they are needed, and a few results at most wait for their turn. The
        function must be one that another process can import.
        """
        ...


def attempt(function: Callable[[Item], Result], item: Item) -> Result | Failed:
    """Return a function's result, or that it failed."""
    try:
        return function(item)
    except RecursionError:
        return Failed("nested too deep")
    except MemoryError:
        return Failed("too large")
    except Exception as error:  # noqa: BLE001 - one item must not end the others
        return Failed(f"{type(error).__name__}: {error}")


def attempt_all(function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result | Failed]:
    """Return each item's result, or that the function failed at it."""
    return [attempt(function, item) for item in items]
