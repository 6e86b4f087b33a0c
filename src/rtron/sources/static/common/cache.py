"""What programs declared when they were interpreted before, kept by the content they were read of.

A result counts while RTron, the workspace's structure, the node's site and every file that was
read for it are the same. The cache is a folder of the user's own: another's is not used.

Which sources a program has, which file an `#include` or `import` means and which messages there
are follow from the names of all files and from the content of a few.
"""

import os
import stat
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from pathlib import Path
from weakref import WeakKeyDictionary

from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticSerializationError

import rtron
from rtron.errors import InputError
from rtron.folders import walk
from rtron.sources.bounded_file import content_hash, read_bounded
from rtron.sources.static.common.task import InterpretationTask, TaskResult
from rtron.sources.workspace import Workspace
from rtron.vocabulary import ParameterTree

MAX_ENTRY = 16 * 1024 * 1024
MAX_BYTES = 256 * 1024 * 1024

_RESULT = TypeAdapter(TaskResult)
_ENDING = ".json"


def user_cache_folder(environ: Mapping[str, str] = os.environ) -> Path:
    """Return the user's cache folder for RTron (XDG Base Directory Specification)."""
    xdg_folder = environ.get("XDG_CACHE_HOME", "")
    home = Path(xdg_folder) if xdg_folder.startswith("/") else Path.home() / ".cache"
    return home / "rtron" / "scan"


@dataclass(slots=True)
class InterfaceCache:
    """Results in a folder; without a folder it is empty.

    `workspace_hash` names what all results depend on.
    """

    folder: Path | None
    workspace_hash: str
    _hashes: dict[str, str] = field(default_factory=dict)
    _parameters: dict[int, tuple[ParameterTree, str]] = field(default_factory=dict)

    def get(self, task: InterpretationTask) -> TaskResult | None:
        """Return a task's result, None if it has none that still counts."""
        if self.folder is None:
            return None
        path = self.folder / self._name(task)
        with suppress(InputError, ValidationError):  # missing or damaged: interpret anew
            result = _RESULT.validate_json(read_bounded(path, MAX_ENTRY))
            if result.files and all(
                self._hash(f) == expected_hash for f, expected_hash in result.files
            ):
                with suppress(OSError):  # the time only decides what is removed first
                    os.utime(path)
                return result
        return None

    def put(self, task: InterpretationTask, result: TaskResult) -> None:
        """Keep a task's result; one that came to nothing has no files and is not kept."""
        if self.folder is None or not result.files:
            return
        with suppress(OSError, PydanticSerializationError):  # the next scan interprets anew
            data = _RESULT.dump_json(result)
            if len(data) <= MAX_ENTRY:
                _write_atomically(self.folder / self._name(task), data)

    def trim(self) -> None:
        """Remove the entries that were not used for longest while there are too many bytes."""
        if self.folder is None:
            return
        with suppress(OSError):  # another scan may remove entries; the next one trims
            entries = [(e.stat().st_mtime, e.stat().st_size, e) for e in self.folder.iterdir()]
            total = sum(size for _, size, _ in entries)
            for _, size, entry in sorted(entries):
                if total <= MAX_BYTES:
                    return
                entry.unlink(missing_ok=True)
                total -= size

    def _name(self, task: InterpretationTask) -> str:
        site = task.site
        parts = (
            self.workspace_hash,
            task.kind.value,
            *map(str, task.sources),
            task.class_name,
            repr(task.other_components),
            repr((site.name, site.args, site.remaps, site.environ, site.parameters_complete)),
            repr(
                (
                    site.ros,
                    site.has_launch_name,
                    site.has_launch_namespace,
                    site.settings,
                    site.overrides,
                    site.loading,
                )
            ),
            repr((site.remap_rules, site.hardware, site.plugin, site.manager)),
            self._parameters_hash(site.parameters),
        )
        return hash_texts(parts) + _ENDING

    def _parameters_hash(self, parameters: ParameterTree) -> str:
        if id(parameters) not in self._parameters:
            texts = (f"{name}={parameter.value!r}" for name, parameter in parameters.leaves.items())
            self._parameters[id(parameters)] = (parameters, hash_texts(sorted(texts)))
        return self._parameters[id(parameters)][1]

    def _hash(self, file: str) -> str:
        if file not in self._hashes:
            self._hashes[file] = content_hash(Path(file))
        return self._hashes[file]


def open_cache(folder: Path | None, workspace_hash: str) -> InterfaceCache:
    """Return the cache in a folder, made if need be; an empty one if it is not the user's alone."""
    if folder is None:
        return InterfaceCache(None, workspace_hash)
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = folder.lstat()
    except (OSError, ValueError):
        return InterfaceCache(None, workspace_hash)
    is_private = stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid()
    return InterfaceCache(
        folder if is_private and not status.st_mode & 0o077 else None, workspace_hash
    )


def hash_texts(parts: Iterable[str]) -> str:
    """Return a hash over texts, in hexadecimal."""
    digest = sha256()
    for part in parts:
        digest.update(f"{len(part)}:{part}\0".encode("utf-8", "surrogateescape"))
    return digest.hexdigest()


def _write_atomically(path: Path, data: bytes) -> None:
    """Write a file whole under a new name, then give it its own: links there are not followed."""
    temporary = path.with_name(f"{path.name}.{os.getpid()}")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
    with suppress(FileNotFoundError):  # the usual case: nothing is left over
        temporary.unlink()
    with os.fdopen(os.open(temporary, flags, 0o600), "wb") as stream:
        stream.write(data)
    temporary.replace(path)


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
