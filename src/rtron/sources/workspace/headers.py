"""Resolves `#include` as a catkin workspace's compiler would, generated headers apart."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from rtron.sources.workspace.package_files import is_regular


def index_folders(folders: Iterable[Path]) -> Mapping[str, tuple[Path, ...]]:
    """Return, for each name (of a module without its ending), the folders that hold it."""
    found: dict[str, list[Path]] = defaultdict(list)
    for folder in folders:
        for name in _entry_names(folder):
            found[name].append(folder)
    return {name: tuple(holding) for name, holding in found.items()}


def find_header(text: str, folders: Sequence[Path]) -> Path | None:
    """Return the first file of this name in folders; None for one that is no relative path."""
    if text.startswith("/"):
        return None
    return next(filter(is_regular, (folder / text for folder in folders)), None)


def _entry_names(folder: Path) -> list[str]:
    try:
        return sorted({entry.name.removesuffix(".py") for entry in folder.iterdir()})
    except OSError:
        return []
