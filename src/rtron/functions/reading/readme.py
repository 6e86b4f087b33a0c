"""The README of a repository's folder."""

from pathlib import Path

from rtron.functions.reading.fields import MAX_TEXT
from rtron.functions.reading.skipped_entries import Note, Skipped
from rtron.sources.workspace.package_files import is_inside, is_regular

_ENDINGS = (".md", ".markdown", ".rst", ".txt", "")


def read_readme(folder: Path, root: Path, note: Note) -> str:
    """Return the beginning of a folder's README, "" without one; a binary one goes to `note`.

    `root` is the real folder of the repository.
    """
    path = find_readme(folder, root)
    if path is None:
        return ""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_TEXT)
    except OSError as error:
        note(Skipped(place=str(path), why=error.strerror or "cannot be read"))
        return ""
    if b"\0" in data:
        note(Skipped(place=str(path), why="is binary"))
        return ""
    return data.decode("utf-8", errors="replace")


def find_readme(folder: Path, root: Path) -> Path | None:
    """Return the README of a folder, Markdown before the others; no link out of the real `root`."""
    found = [
        path
        for path in folder.glob("[Rr][Ee][Aa][Dd][Mm][Ee]*")
        if path.suffix.lower() in _ENDINGS and is_regular(path) and is_inside(path, (root,))
    ]
    return min(found, key=_rank, default=None)


def _rank(path: Path) -> tuple[int, str]:
    return _ENDINGS.index(path.suffix.lower()), path.name
