"""Classifies repositories, wherever that is asked to be done, and shows how far it is."""

from collections.abc import Iterator, Sequence

from rtron.executors.chunked_map import CHUNK_SIZE
from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import Classification
from rtron.functions.reading import SkippedHandler
from rtron.functions.repository import SourceRepository
from rtron.workflows.parallel_map import choose_executor, map_with_progress

_PARALLEL_THRESHOLD = 2000
"""Repositories that are done here sooner than other processes have started."""


def classify_repositories(
    repositories: Sequence[SourceRepository],
    jobs: int | None,
    cluster: str | None,
    note_skipped: SkippedHandler,
) -> Iterator[tuple[SourceRepository, Classification]]:
    """Return repositories with their classes, in `jobs` processes or on a cluster if given.

    One at which the work fails goes to `note_skipped`. Raise InputError and SourceError as executors do.
    """
    executor = choose_executor(
        jobs, cluster, chunk=CHUNK_SIZE, is_worth_parallel=len(repositories) > _PARALLEL_THRESHOLD
    )
    return map_with_progress(executor, classify, repositories, lambda each: each.name, note_skipped)
