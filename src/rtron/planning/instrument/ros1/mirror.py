"""A folder as it is, by links, except for some files in it."""

import os
from collections.abc import Collection, Iterator
from pathlib import Path

from rtron.errors import InputError

MAX_LINKS = 20_000


def mirror_links(root: Path, changed: Collection[Path], left_out: Collection[Path]) -> list[Path]:
    """Return what must be linked so that a mirror of `root` lacks only the files `changed`.

    Folders on the way to a changed file are made anew, all beside them is linked; what is
    `left_out` is not, so that no link leads to it. Raise InputError if a folder cannot be listed
    or has too much in it.
    """
    excluded = {*changed, *left_out}
    above = (parent for path in excluded for parent in path.parents)
    folders = {folder for folder in above if folder.is_relative_to(root) and folder.is_dir()}
    not_linked = folders | excluded
    links: list[Path] = []
    for folder in sorted(folders):
        links += (path for path in _listed(folder) if path not in not_linked)
        if len(links) > MAX_LINKS:
            help = "write the guarded launch for fewer packages"
            raise InputError(f"holds more than {MAX_LINKS} files", path=str(folder), help=help)
    return links


def _listed(folder: Path) -> Iterator[Path]:
    try:
        yield from (folder / name for name in sorted(os.listdir(folder)))  # noqa: PTH208
    except OSError as error:
        raise InputError(f"cannot be listed: {error.strerror}", path=str(folder)) from None
