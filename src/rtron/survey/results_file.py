"""Results of a survey as they come, so that the same survey goes on where it was ended.

A line of JSON for each app, with the digest of what it was made of. A line is written whole or, if
the machine stops at that moment, is damaged and left out. The file lies in the user's cache.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from rtron.errors import InputError
from rtron.sources.bounded_file import read_bounded
from rtron.sources.static.common.cache import user_cache_folder
from rtron.survey.app_listing import AppToScan
from rtron.survey.app_survey import AppResult

_MAX_BYTES = 2**30


@dataclass(frozen=True, slots=True, kw_only=True)
class _StoredResult:
    """A result, the digest of its app, and the seconds that the scan was given."""

    digest: str
    limit: float
    result: AppResult


_ADAPTER: TypeAdapter[_StoredResult] = TypeAdapter(_StoredResult)


@dataclass(frozen=True, slots=True)
class ResultsFile:
    """The results of the surveys of one folder; without a path it keeps nothing."""

    path: Path | None

    def read(self, apps: Sequence[AppToScan], limit: float) -> Mapping[str, AppResult]:
        """Return the results that still count, by app.

        One without a survey counts if the app's own files are the reason, and a longer limit than
        `limit` would not help.
        """
        digests = {app.name: app.digest for app in apps}
        return {
            stored.result.app: stored.result
            for stored in self._stored()
            if digests.get(stored.result.app) == stored.digest
            and (stored.result.survey or (stored.result.is_final and stored.limit >= limit))
        }

    def add(self, app: AppToScan, result: AppResult, limit: float) -> None:
        """Add a result in one write; a disk that is full or read-only costs the next run time."""
        if self.path is None:
            return
        line = _ADAPTER.dump_json(_StoredResult(digest=app.digest, limit=limit, result=result))
        flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        with suppress(OSError):
            file = os.open(self.path, flags, 0o600)
            try:
                os.write(file, b"\n" + line + b"\n")
            finally:
                os.close(file)

    def compact(self, apps: Sequence[AppToScan], limit: float) -> None:
        """Leave out the lines that do not count any more."""
        if self.path is None or not self.path.exists():
            return
        digests = {app.name: app for app in apps}
        valid = self.read(apps, limit)
        temporary = self.path.with_suffix(f".{os.getpid()}")
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
            fresh = ResultsFile(temporary)
            for name, result in valid.items():
                fresh.add(digests[name], result, limit)
            temporary.replace(self.path)

    def _stored(self) -> Iterator[_StoredResult]:
        if self.path is None:
            return
        try:
            lines = read_bounded(self.path, _MAX_BYTES).splitlines()
        except InputError:
            return
        for line in filter(None, lines):
            with suppress(ValidationError):  # a line that was not written whole
                yield _ADAPTER.validate_json(line)


def results_file(folder: Path) -> ResultsFile:
    """Return the file for the surveys of a folder; one that keeps nothing if it cannot be made."""
    home = user_cache_folder().with_name("survey")
    try:
        home.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = home.lstat()
    except OSError:
        return ResultsFile(None)
    is_private = status.st_uid == os.getuid() and not status.st_mode & 0o077
    name = sha256(os.fsencode(folder.resolve())).hexdigest()[:16]
    return ResultsFile(home / f"{name}.jsonl" if is_private else None)
