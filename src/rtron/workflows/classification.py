"""Classify repositories by function, in this process or in many."""

from collections.abc import Iterator, Sequence
from operator import attrgetter

from rtron.executors.chunked_map import CHUNK_SIZE
from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import Classification
from rtron.functions.reading import SkippedHandler
from rtron.functions.reading.package_code import read_code
from rtron.functions.repository import SourceRepository
from rtron.sources.static.common.scan_options import Progress
from rtron.workflows.parallel_map import choose_executor, map_with_progress

_PARALLEL_THRESHOLD = 2000
"""So many repositories take less time here than other processes take to start."""


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
