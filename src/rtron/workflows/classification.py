"""Classify repositories by function."""

from collections.abc import Iterator, Sequence

from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import Classification
from rtron.functions.reading import SkippedEntry, SkippedHandler
from rtron.functions.reading.package_code import read_code
from rtron.functions.repository import SourceRepository
from rtron.sources.static.common.scan_options import Progress


def classify_repositories(
    repositories: Sequence[SourceRepository], note_skipped: SkippedHandler, progress: Progress
) -> Iterator[tuple[SourceRepository, Classification]]:
    """Yield repositories with their classes; the code of those that are folders is read.

    A repository that fails costs itself only, and goes to `note_skipped`.
    """
    for done, repository in enumerate(repositories, 1):
        progress(done, len(repositories), repository.name)
        try:
            found = classify(read_code(repository))
        except Exception as error:  # noqa: BLE001 - one of thousands must not end the others
            reason = f"{type(error).__name__}: {error}"
            note_skipped(SkippedEntry(location=repository.name, reason=reason))
        else:
            yield repository, found
