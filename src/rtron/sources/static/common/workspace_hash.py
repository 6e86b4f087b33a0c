"""A hash over what a workspace's packages are made of, apart from the content of their code.

Which sources a program has, which file an `#include` or `import` means and which messages there
are follow from the names of all files and from the content of a few.
"""

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import rtron
from rtron.folders import walk
from rtron.sources.bounded_file import content_hash
from rtron.sources.static.common.cache import digest_of
from rtron.sources.workspace import Workspace

_READ = (".xml", ".cmake", "CMakeLists.txt", "setup.py", "setup.cfg")


def workspace_state(workspace: Workspace) -> str:
    """Return the hash of RTron itself and of a workspace's structure."""
    parts = [_own_code(), *map(str, workspace.folders)]
    for name, package in sorted(workspace.packages.items()):
        parts.extend((name, str(package), *_listed(package)))
    return digest_of(parts)


def _listed(package: Path) -> Iterator[str]:
    for folder, subfolders, files in walk(package):
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        for name in sorted(files):
            path = Path(folder, name)
            yield f"{path} {_mode(path)}"
            if name.endswith(_READ):
                yield content_hash(path)


def _mode(path: Path) -> int:
    try:
        return path.stat().st_mode & 0o111
    except OSError:
        return 0


@cache
def _own_code() -> str:
    folder = Path(rtron.__file__).parent / "sources"
    return digest_of(content_hash(path) for path in sorted(folder.rglob("*.py")))
