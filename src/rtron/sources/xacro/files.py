"""The files that a description names: relative to the file it is written in, or with wildcards."""

import os.path
import re
from itertools import islice
from pathlib import Path

from rtron.sources.launch.common.errors import UnresolvableError

MAX_MATCHES = 200

_WILDCARD = re.compile(r"[*\[?]")


def local_path(name: str, file: str) -> Path:
    """Return the path that `name` means in `file`, `..` taken out without a look at it."""
    return Path(os.path.normpath(os.path.join(os.path.dirname(file), name)))  # noqa: PTH118, PTH120


def included_files(name: str, file: str) -> list[Path]:
    """Return the files that an include names, in order; wildcards stand in the last part only."""
    if not name.strip() or "\0" in name:
        raise ValueError(f"{name!r} is no file name")
    path = local_path(name, file)
    if not _WILDCARD.search(name):
        return [path]
    if _WILDCARD.search(str(path.parent)):
        raise UnresolvableError(f"{name}: wildcards in a folder's name are not followed")
    return sorted(islice(path.parent.glob(path.name), MAX_MATCHES))
