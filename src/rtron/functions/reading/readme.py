"""The README of a repository's folder."""

from pathlib import Path

from rtron.functions.reading.fields import MAX_TEXT
from rtron.functions.reading.skipped_entries import SkippedEntry, SkippedHandler
from rtron.sources.workspace.package_files import is_inside, is_regular

_EXTENSIONS = (".md", ".markdown", ".rst", ".txt", "")


def read_readme(folder: Path, root: Path, on_skipped: SkippedHandler) -> str:
    """Return the beginning of a folder's README, "" without one; a binary one goes to `on_skipped`.

    `root` is the real folder of the repository.
    """
    path = find_readme(folder, root)
    if path is None:
        return ""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_TEXT)
    except OSError as error:
        on_skipped(SkippedEntry(location=str(path), reason=error.strerror or "cannot be read"))
        return ""
    if b"\0" in data:
        on_skipped(SkippedEntry(location=str(path), reason="is binary"))
        return ""
    return data.decode("utf-8", errors="replace")


def find_readme(folder: Path, root: Path) -> Path | None:
    """Return the README of a folder, Markdown before the others; no link out of the real `root`."""
    candidates = [
        path
        for path in folder.glob("[Rr][Ee][Aa][Dd][Mm][Ee]*")
        if path.suffix.lower() in _EXTENSIONS and is_regular(path) and is_inside(path, (root,))
    ]
    return min(candidates, key=_rank, default=None)


def _rank(path: Path) -> tuple[int, str]:
    return _EXTENSIONS.index(path.suffix.lower()), path.name
