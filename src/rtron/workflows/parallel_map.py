"""Where a command about many things works: here, in processes, or on a cluster."""

from collections.abc import Callable, Iterator, Sequence
from typing import Annotated, TypeVar

import typer

from rtron.cli.support.progress import show_progress
from rtron.errors import InputError
from rtron.executors import ItemFailure, MapExecutor
from rtron.functions.reading import SkippedEntry, SkippedHandler

ProcessCount = Annotated[
    int | None,
    typer.Option(
        "--jobs", "-j", min=1, metavar="N", help="Work in N processes; no more than cores."
    ),
]
ClusterAddress = Annotated[
    str | None,
    typer.Option("--cluster", metavar="ADDRESS", help="Work on a Dask cluster that you trust."),
]


def choose_executor(
    jobs: int | None, cluster: str | None, *, chunk: int, is_worth_parallel: bool
) -> "MapExecutor":
    """Return what is asked for, of cores no more than there are.

    By default that is all of them if the work is worth it, else this process.

    `chunk` things go to a worker together. Raise InputError if both are asked for.
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
