"""Files of which a crash or a power cut at any moment leaves the old or the new, whole."""

import os
from pathlib import Path

_PRIVATE = 0o600


def replace_file(path: Path, data: bytes) -> None:
    """Write a file that only its owner may read; OSError if it is not on the disk then."""
    new = path.with_suffix(".new")
    with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, _PRIVATE), "wb") as file:
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
