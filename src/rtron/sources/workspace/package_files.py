"""The files of a package: listed once, links not followed into other folders."""

import os
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import translate
from functools import cached_property, lru_cache
from pathlib import Path, PurePath

from rtron.errors import InputError
from rtron.folders import walk
from rtron.sources.bounded_file import read_regular_file

MAX_FILES = 50_000


@dataclass(frozen=True, kw_only=True)
class PackageFiles:
    """The files below a package's folder, relative to it, sorted; hidden folders are left out.

    `roots` are the real folders that a file may lie in; a link that leads out of them is no file.
    """

    folder: Path
    roots: tuple[Path, ...]
    names: tuple[str, ...] = ()
    _by_name: Mapping[str, list[str]] = field(default_factory=dict, repr=False)
    _by_folder: Mapping[str, list[str]] = field(default_factory=dict, repr=False)

    def files_named(self, name: str) -> tuple[Path, ...]:
        """Return the files with this name, in whatever folder."""
        return tuple(self.folder / found for found in self._by_name.get(name, ()))

    def is_file(self, path: Path) -> bool:
        """Return whether a path is a regular file inside the roots."""
        return is_inside(path, self.roots) and is_regular(path)

    def is_folder(self, path: Path) -> bool:
        """Return whether a path is a folder inside the roots."""
        return is_inside(path, self.roots) and path.is_dir()

    def glob(self, pattern: str, *, recursive: bool, with_folders: bool) -> tuple[Path, ...]:
        """Return the files and folders that a pattern of CMake's file(GLOB) names, an absolute one.

        The last part of a recursive one is looked for in all folders below the rest of it.
        """
        relative = os.path.relpath(os.path.normpath(pattern), self.folder)
        folder, _, last = relative.rpartition("/")
        parts = folder.split("/") if folder else []
        folders = self._folders_by_parent if with_folders else {}
        return tuple(
            self.folder / below / name
            for group in (self._by_folder, folders)
            for below, names in group.items()
            if _matches_folder(below.split("/") if below else [], parts, recursive=recursive)
            for name in names
            if _pattern(last).match(name)
        )

    @cached_property
    def _folders_by_parent(self) -> Mapping[str, list[str]]:
        """The folders that hold files, at whatever depth, by the folder that they lie in."""
        holding = (PurePath(name).parents for name in self._by_folder)
        inner = {str(parent) for parents in holding for parent in parents} | {*self._by_folder}
        pairs = (name.rpartition("/") for name in sorted(inner - {".", ""}))
        return _group_by_key((parent, last) for parent, _, last in pairs)


def list_files(folder: Path, roots: tuple[Path, ...]) -> PackageFiles:
    """Return a package's files; what cannot be listed is left out."""
    names: list[str] = []
    for parent, folders, files in walk(folder):
        prefix = os.path.relpath(parent, folder) + "/"
        prefix = "" if prefix == "./" else prefix
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        names.extend(prefix + name for name in files)
        if len(names) > MAX_FILES:
            break
    names = sorted(names)[:MAX_FILES]
    split = [name.rpartition("/") for name in names]
    return PackageFiles(
        folder=folder,
        roots=(*roots, folder.resolve()),
        names=tuple(names),
        _by_name=_group_by_key(
            (last, name) for name, (_, _, last) in zip(names, split, strict=True)
        ),
        _by_folder=_group_by_key((parent, last) for parent, _, last in split),
    )


def is_regular(path: Path) -> bool:
    """Return whether a path is a regular file; one that no file can have is not."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_inside(path: Path, folders: tuple[Path, ...]) -> bool:
    """Return whether a path exists and, its links followed, lies in one of some real folders."""
    try:
        real = path.resolve()
        path.stat()
    except (OSError, RuntimeError, ValueError):
        return False
    return any(real.is_relative_to(folder) for folder in folders)


def _matches_folder(folder: Sequence[str], patterns: Sequence[str], *, recursive: bool) -> bool:
    enough = len(folder) >= len(patterns) if recursive else len(folder) == len(patterns)
    return enough and all(
        _pattern(pattern).match(part) for part, pattern in zip(folder, patterns, strict=False)
    )


@lru_cache(maxsize=1024)
def _pattern(part: str) -> re.Pattern[str]:
    return re.compile(translate(part))


def _group_by_key(pairs: Iterable[tuple[str, str]]) -> Mapping[str, list[str]]:
    groups: dict[str, list[str]] = defaultdict(list)
    for key, value in pairs:
        groups[key].append(value)
    return dict(groups)


_BUILD_FILES = ("CMakeLists.txt", "setup.py", "setup.cfg", "pyproject.toml")
_MAX_BUILD_FILES = 100
_MAX_BUILD_FILE_BYTES = 2**20
_COMMENT = re.compile(rb"#.*")
_CALL = (
    rb"\b(?:\w{0,40}executable\w{0,40}|install|catkin_install_python|set|list|foreach|"
    rb"ament_\w+|rclcpp_\w+)"
    rb"\s*\([^()]{0,500}(?<![\w.])%s(?![\w.])"
)
_ENTRY_POINT = rb"(?:^|[\"'])\s*%s\s*="
"""How CMake's calls, and lists of entry points, name a program."""


def is_in_build_files(files: PackageFiles, program: str) -> bool:
    """Return whether a build file of a package names a program, outside of comments."""
    word = re.escape(program.encode(errors="surrogatepass"))
    patterns = [re.compile(each % word, re.MULTILINE) for each in (_CALL, _ENTRY_POINT)]
    names = [n for n in files.names if n.endswith(".cmake") or n.rpartition("/")[2] in _BUILD_FILES]
    paths = filter(files.is_file, (files.folder / name for name in names[:_MAX_BUILD_FILES]))
    texts = (_COMMENT.sub(b"", _text(path)) for path in paths)
    return any(pattern.search(text) for text in texts for pattern in patterns)


def _text(path: Path) -> bytes:
    try:
        return read_regular_file(path, _MAX_BUILD_FILE_BYTES)
    except InputError:
        return b""


_ENDINGS = {
    ".msg": ("",),
    ".srv": ("", "Request", "Response"),
    ".action": (
        *("Action", "Goal", "Result", "Feedback"),
        *("ActionGoal", "ActionResult", "ActionFeedback"),
    ),
}


def message_names(files: PackageFiles) -> frozenset[str]:
    """Return the names of the types that are made from *.msg, *.srv and *.action files."""
    names = (name.rpartition("/")[2].rpartition(".") for name in files.names)
    return frozenset(
        stem + ending for stem, dot, suffix in names for ending in _ENDINGS.get(dot + suffix, ())
    )


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
    paths = (Path(os.path.normpath(folder / text)) for folder in folders)
    return next(filter(is_regular, paths), None)


def _entry_names(folder: Path) -> list[str]:
    try:
        return sorted({entry.name.removesuffix(".py") for entry in folder.iterdir()})
    except OSError:
        return []
