"""Work on many things, wherever that is asked to be done, and show how far it is."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from rtron.cli.support.progress import show_progress
from rtron.executors import ItemFailure, MapExecutor
from rtron.functions.reading import SkippedEntry, SkippedHandler

Item = TypeVar("Item")
Result = TypeVar("Result")


def map_with_progress(
    executor: MapExecutor,
    function: Callable[[Item], Result],
    items: Sequence[Item],
    name: Callable[[Item], str],
    note_skipped: SkippedHandler,
) -> Iterator[tuple[Item, Result]]:
    """Yield each item with its result; one at which the function failed goes to `note_skipped`."""
    with show_progress() as progress:
        results = executor.map(function, items)
        for done, (item, result) in enumerate(zip(items, results, strict=True), 1):
            progress(done, len(items), name(item))
            if isinstance(result, ItemFailure):
                note_skipped(SkippedEntry(location=name(item), reason=result.reason))
            else:
                yield item, result
