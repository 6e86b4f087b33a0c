"""Classify repositories by function, in this process or in many."""

from collections.abc import Callable, Iterator, Sequence
from operator import attrgetter
from typing import TypeVar

from rtron.errors import InputError
from rtron.executors import ItemFailure, MapExecutor
from rtron.executors.chunked_map import CHUNK_SIZE
from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import Classification
from rtron.functions.reading import SkippedEntry, SkippedHandler
from rtron.functions.reading.package_code import read_code
from rtron.functions.repository import SourceRepository
from rtron.sources.static.common.scan_options import Progress

_PARALLEL_THRESHOLD = 2000
"""So many repositories take less time here than other processes take to start."""
Item = TypeVar("Item")
Result = TypeVar("Result")


def classify_repositories(
    repositories: Sequence[SourceRepository],
    jobs: int | None,
    cluster: str | None,
    note_skipped: SkippedHandler,
    progress: Progress,
) -> Iterator[tuple[SourceRepository, Classification]]:
    """Yield repositories with their classes, in `jobs` processes or on a cluster if given.

    The code of those that are folders is read here: no worker needs the folders.
    A repository that fails goes to `note_skipped`. Raise the errors of the executors.
    """
    executor = choose_executor(
        jobs, cluster, chunk=CHUNK_SIZE, is_worth_parallel=len(repositories) > _PARALLEL_THRESHOLD
    )
    by_name = {each.name: each for each in repositories}
    with_code = [read_code(each) for each in repositories]
    name = attrgetter("name")
    classified = map_with_progress(executor, classify, with_code, name, note_skipped, progress)
    return ((by_name[each.name], found) for each, found in classified)


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
