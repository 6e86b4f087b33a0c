"""Classifies repositories, wherever that is asked to be done, and shows how far it is."""

from collections.abc import Iterator, Sequence

from rtron.cli.working import worked
from rtron.executors.chunked_map import CHUNK
from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import Classification
from rtron.functions.reading import Note
from rtron.functions.repository import Repository
from rtron.workflows.parallel_map import chosen_executor

_FEW = 2000
"""Repositories that are done here sooner than other processes have started."""


def classified(
    repositories: Sequence[Repository], jobs: int | None, cluster: str | None, left: Note
) -> Iterator[tuple[Repository, Classification]]:
    """Return repositories with their classes, in `jobs` processes or on a cluster if given.

    One at which the work fails goes to `left`. Raise InputError and SourceError as executors do.
    """
    executor = chosen_executor(jobs, cluster, chunk=CHUNK, worth=len(repositories) > _FEW)
    return worked(executor, classify, repositories, lambda each: each.name, left)
