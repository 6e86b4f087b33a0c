"""Work on many things, wherever that is asked to be done, and show how far it is."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from rtron.cli.support.progress import shown_progress
from rtron.executors import Executor, Failed
from rtron.functions.reading import Note, Skipped

Item = TypeVar("Item")
Result = TypeVar("Result")


def worked(
    executor: Executor,
    function: Callable[[Item], Result],
    items: Sequence[Item],
    name: Callable[[Item], str],
    left: Note,
) -> Iterator[tuple[Item, Result]]:
    """Yield each item with its result; one at which the function failed goes to `left`."""
    with shown_progress() as progress:
        results = executor.map(function, items)
        for done, (item, result) in enumerate(zip(items, results, strict=True), 1):
            progress(done, len(items), name(item))
            if isinstance(result, Failed):
                left(Skipped(place=name(item), why=result.why))
            else:
                yield item, result
