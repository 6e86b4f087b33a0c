"""The lines of source that findings come from, for reports that show them."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.vocabulary import Evidence, Finding

_MAX_BYTES = 4 << 20
_MAX_LENGTH = 200
_MAX_LINES = 2000


def read_source_lines(findings: Iterable[Finding], root: Path | None) -> dict[Evidence, str]:
    """Return the line of each place in a file below `root`; what cannot be read is left out."""
    if root is None:
        return {}
    places = dict.fromkeys(at for each in findings for at in each.evidence if at.file and at.line)
    files: dict[str, list[str]] = {}
    return dict(_lines(list(places)[:_MAX_LINES], root, files))


def _lines(
    places: Iterable[Evidence], root: Path, files: dict[str, list[str]]
) -> Iterator[tuple[Evidence, str]]:
    for at in places:
        if at.file not in files:
            files[at.file] = _file_lines(root, at.file)
        if at.line <= len(files[at.file]):
            yield at, files[at.file][at.line - 1].strip()[:_MAX_LENGTH]


def _file_lines(root: Path, name: str) -> list[str]:
    path = (root / name).resolve()
    if not path.is_relative_to(root.resolve()):
        return []
    try:
        return read_regular_file(path, _MAX_BYTES).decode("utf-8", errors="replace").splitlines()
    except InputError:
        return []
