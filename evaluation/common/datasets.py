"""Where the apps and the ground truth lie."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from figures.figure import Figure


class MissingDatasetError(Exception):
    """What a part needs is not here."""


@dataclass(frozen=True, slots=True)
class Datasets:
    """The folder of apps and that of the data; None where the environment names none."""

    apps: Path | None
    data: Path | None

    def repositories(self, names: Iterable[str]) -> list[Path]:
        """Return the folders of repositories (`owner/name@commit`); raise MissingDatasetError."""
        folders = [self._apps() / name for name in names]
        missing = [folder.name for folder in folders if not folder.is_dir()]
        if missing:
            raise MissingDatasetError(f"RTRON_APPS lacks {', '.join(missing)}")
        return folders

    def present(self, names: Iterable[str]) -> list[Path]:
        """Return those of some repositories that are here."""
        return [folder for name in names if (folder := self._apps() / name).is_dir()]

    def all_repositories(self) -> list[Path]:
        """Return every repository, by name; raise MissingDatasetError without a folder of them."""
        return sorted(path for path in self._apps().glob("*/*") if path.is_dir())

    def truth(self, name: str) -> Path:
        """Return a file of the ground truth; raise MissingDatasetError if it is not here."""
        return self._file("groundtruth", name)

    def corpus(self, name: str) -> Path:
        """Return a file of the corpus; raise MissingDatasetError if it is not here."""
        return self._file("corpus", name)

    def _file(self, folder: str, name: str) -> Path:
        if self.data is None:
            raise MissingDatasetError(f"RTRON_DATA names no folder that holds {folder}/")
        path = self.data / folder / name
        if not path.is_file():
            raise MissingDatasetError(f"RTRON_DATA lacks {folder}/{name}")
        return path

    def _apps(self) -> Path:
        if self.apps is None or not self.apps.is_dir():
            raise MissingDatasetError("RTRON_APPS names no folder of apps")
        return self.apps


def datasets_from_environ(environ: Mapping[str, str] = os.environ) -> Datasets:
    """Return the folders that the environment names."""
    apps, data = environ.get("RTRON_APPS"), environ.get("RTRON_DATA")
    return Datasets(
        Path(apps).absolute() if apps else None, Path(data).absolute() if data else None
    )


@dataclass(frozen=True, slots=True)
class Reporter:
    """Takes what is being done, and lines for a person; `detail` is for those who ask for it."""

    progress: Callable[[str], None]
    lines: Callable[[Sequence[str]], None]
    detail: Callable[[Sequence[str]], None]


Part = Callable[[Datasets, Reporter], Iterator[Figure]]
"""Measures; gives each figure as soon as it is known; raises MissingDatasetError without data."""
