"""A hash over what a workspace's packages are made of, apart from the content of their code.

Which sources a program has, which file an `#include` or `import` means and which messages there
are follow from the names of all files and from the content of a few.
"""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from weakref import WeakKeyDictionary

import rtron
from rtron.folders import walk
from rtron.sources.bounded_file import content_hash
from rtron.sources.static.common.cache import hash_texts
from rtron.sources.workspace import Workspace

_BUILD_FILE_SUFFIXES = (".xml", ".cmake", "CMakeLists.txt", "setup.py", "setup.cfg")


_HASHES: WeakKeyDictionary[Workspace, str] = WeakKeyDictionary()


def hash_workspace(workspace: Workspace) -> str:
    """Return the hash of RTron itself and of a workspace's structure, at the first call."""
    if workspace not in _HASHES:
        parts = [_hash_own_code(), *map(str, workspace.folders)]
        for name, package in sorted(workspace.packages.items()):
            parts.extend((name, str(package), *_package_entries(package)))
        _HASHES[workspace] = hash_texts(parts)
    return _HASHES[workspace]


def _package_entries(package: Path) -> Iterator[str]:
    for folder, subfolders, files in walk(package):
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        for name in sorted(files):
            path = Path(folder, name)
            yield f"{path} {_executable_bits(path)}"
            if name.endswith(_BUILD_FILE_SUFFIXES):
                yield content_hash(path)


def _executable_bits(path: Path) -> int:
    try:
        return path.stat().st_mode & 0o111
    except OSError:
        return 0


@cache
def _hash_own_code() -> str:
    folder = Path(rtron.__file__).parent / "sources"
    return hash_texts(content_hash(path) for path in sorted(folder.rglob("*.py")))
