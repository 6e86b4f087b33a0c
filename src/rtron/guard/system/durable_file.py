"""Files of which a crash or a power cut at any moment leaves the old or the new, whole."""

import os
from pathlib import Path

_PRIVATE = 0o600


def make_private_folder(folder: Path) -> None:
    """Make a folder, and those above it that are not there, for this user alone (XDG folders)."""
    if not folder.is_dir():
        make_private_folder(folder.parent)
        folder.mkdir(mode=0o700, exist_ok=True)
        _sync_folder(folder.parent)


def replace_file(path: Path, data: bytes, mode: int = _PRIVATE) -> None:
    """Write a file that only its owner may read, or `mode`; OSError if it is not on the disk."""
    new = path.with_name(f"{path.name}.new")
    new.unlink(missing_ok=True)
    with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    new.replace(path)
    _sync_folder(path.parent)


def remove_file(path: Path) -> None:
    """Remove a file; OSError if it is not gone from the disk then."""
    if path.exists():
        path.unlink()
        _sync_folder(path.parent)


def _sync_folder(path: Path) -> None:
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
