"""Apply a function to many items: in this process, in several, or on a cluster."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from rtron.errors import InputError
from rtron.executors import ItemFailure, MapExecutor
from rtron.functions.reading import SkippedEntry, SkippedHandler
from rtron.sources.static.common.scan_options import Progress

Item = TypeVar("Item")
Result = TypeVar("Result")


def choose_executor(
    jobs: int | None, cluster: str | None, *, chunk: int, is_worth_parallel: bool
) -> MapExecutor:
    """Return an executor of `jobs` processes, at most one for each core, or of a cluster.

    The default is all cores if the work is worth it, else this process. A worker gets `chunk`
    items at a time. Raise InputError if both `jobs` and `cluster` are given.
    """
    from rtron.executors import DaskExecutor, ProcessExecutor, SerialExecutor  # noqa: PLC0415 - the guard starts without it
    from rtron.sources.static.common.scan_options import default_workers  # noqa: PLC0415 - the guard starts without it

    if cluster and jobs:
        help = "leave one of the two out: a cluster has its own workers"
        raise InputError("both --cluster and --jobs are given", help=help)
    if cluster:
        return DaskExecutor(cluster, chunk)
    cores = default_workers()
    count = min(jobs or (cores if is_worth_parallel else 1), cores)
    return ProcessExecutor(count, chunk) if count > 1 else SerialExecutor()


def map_with_progress(
    executor: MapExecutor,
    function: Callable[[Item], Result],
    items: Sequence[Item],
    name: Callable[[Item], str],
    note_skipped: SkippedHandler,
    progress: Progress,
) -> Iterator[tuple[Item, Result]]:
    """Yield each item with its result; one at which the function failed goes to `note_skipped`."""
    results = executor.map(function, items)
    for done, (item, result) in enumerate(zip(items, results, strict=True), 1):
        progress(done, len(items), name(item))
        if isinstance(result, ItemFailure):
            note_skipped(SkippedEntry(location=name(item), reason=result.reason))
        else:
            yield item, result
