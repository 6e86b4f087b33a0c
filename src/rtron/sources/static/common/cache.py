"""What programs declared when they were interpreted before, kept by the content they were read of.

A result counts while RTron, the workspace's structure, the node's site and every file that was
read for it are the same. The cache is a folder of the user's own: another's is not used.
"""

import os
import stat
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from rtron.errors import InputError
from rtron.sources.bounded_file import content_hash, read_bounded
from rtron.sources.static.common.task import Task, TaskResult
from rtron.vocabulary import Parameters

MAX_ENTRY = 16 * 1024 * 1024
MAX_BYTES = 256 * 1024 * 1024

_RESULT = TypeAdapter(TaskResult)
_ENDING = ".json"


def user_cache(environ: Mapping[str, str] = os.environ) -> Path:
    """Return the user's cache folder for RTron (XDG Base Directory Specification)."""
    below = environ.get("XDG_CACHE_HOME", "")
    home = Path(below) if below.startswith("/") else Path.home() / ".cache"
    return home / "rtron" / "scan"


@dataclass(slots=True)
class Cache:
    """Results in a folder; `state` names what they all depend on. Without a folder it is empty."""

    folder: Path | None
    state: str
    _hashes: dict[str, str] = field(default_factory=dict)
    _parameters: dict[int, tuple[Parameters, str]] = field(default_factory=dict)

    def get(self, task: Task) -> TaskResult | None:
        """Return a task's result, None if it has none that still counts."""
        if self.folder is None:
            return None
        path = self.folder / self._name(task)
        with suppress(InputError, ValidationError):
            result = _RESULT.validate_json(read_bounded(path, MAX_ENTRY))
            if result.files and all(self._hash(f) == known for f, known in result.files):
                with suppress(OSError):
                    os.utime(path)
                return result
        return None

    def put(self, task: Task, result: TaskResult) -> None:
        """Keep a task's result; one that came to nothing has no files and is not kept."""
        if self.folder is None or not result.files:
            return
        data = _RESULT.dump_json(result)
        if len(data) <= MAX_ENTRY:
            with suppress(OSError):
                _replace(self.folder / self._name(task), data)

    def trim(self) -> None:
        """Remove the entries that were not used for longest while there are too many bytes."""
        if self.folder is None:
            return
        with suppress(OSError):
            entries = [(e.stat().st_mtime, e.stat().st_size, e) for e in self.folder.iterdir()]
            total = sum(size for _, size, _ in entries)
            for _, size, entry in sorted(entries):
                if total <= MAX_BYTES:
                    return
                entry.unlink(missing_ok=True)
                total -= size

    def _name(self, task: Task) -> str:
        site = task.site
        parts = (
            self.state,
            task.kind.value,
            *map(str, task.sources),
            task.cls,
            repr(task.beside),
            repr((site.name, site.args, site.remaps, site.environ, site.complete)),
            repr((site.ros, site.named, site.placed, site.settings, site.overrides, site.loading)),
            repr(site.rules),
            self._parameters_hash(site.parameters),
        )
        return digest_of(parts) + _ENDING

    def _parameters_hash(self, parameters: Parameters) -> str:
        if id(parameters) not in self._parameters:
            texts = (f"{name}={found.value!r}" for name, found in parameters.leaves.items())
            self._parameters[id(parameters)] = (parameters, digest_of(sorted(texts)))
        return self._parameters[id(parameters)][1]

    def _hash(self, file: str) -> str:
        if file not in self._hashes:
            self._hashes[file] = content_hash(Path(file))
        return self._hashes[file]


def open_cache(folder: Path | None, state: str) -> Cache:
    """Return the cache in a folder, made if need be; an empty one if it is not the user's alone."""
    if folder is None:
        return Cache(None, state)
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = folder.lstat()
    except (OSError, ValueError):
        return Cache(None, state)
    ours = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    return Cache(folder if ours and not found.st_mode & 0o077 else None, state)


def digest_of(parts: Iterable[str]) -> str:
    """Return a hash over texts, in hexadecimal."""
    whole = sha256()
    for part in parts:
        whole.update(f"{len(part)}:{part}\0".encode("utf-8", "surrogateescape"))
    return whole.hexdigest()


def _replace(path: Path, data: bytes) -> None:
    """Write a file whole under a new name, then give it its own: links there are not followed."""
    made = path.with_name(f"{path.name}.{os.getpid()}")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
    with suppress(FileNotFoundError):
        made.unlink()
    with os.fdopen(os.open(made, flags, 0o600), "wb") as stream:
        stream.write(data)
    made.replace(path)
