"""What runs when a launch names an executable: its language and its files.

A script is found as rosrun does: by name, in any folder (ROS wiki: rosbash).
"""

import hashlib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from rtron.sources.bounded_file import content_hash
from rtron.sources.workspace.package_contents import BuildTarget, PackageContents, TargetKind
from rtron.sources.workspace.package_files import PackageFiles
from rtron.vocabulary import StringEnum


class ProgramLanguage(StringEnum):
    """What a program is written in."""

    CPP = "cpp"
    PYTHON = "python"
    SHELL = "sh"
    OTHER = "other"


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """An executable, a library or a script of a package.

    `sources` are its own files and those of the libraries of its package that it links, its own
    first. `entry` is the function of a Python module that is called, or the class of a component;
    empty where the file itself is run.
    """

    name: str
    package: str
    language: ProgramLanguage
    sources: tuple[Path, ...] = ()
    definitions: tuple[str, ...] = ()
    entry: str = ""


_PREFERRED = ("scripts", "nodes", "bin", "src")
_SUFFIXES = {
    ".py": ProgramLanguage.PYTHON,
    ".sh": ProgramLanguage.SHELL,
    ".bash": ProgramLanguage.SHELL,
}
_SHEBANG = re.compile(rb"#![^\n]*?\b(python|bash|zsh|sh)[\d.]*\b")
_SHEBANG_BYTES = 256
_T = TypeVar("_T")


def target_program(target: BuildTarget, contents: PackageContents) -> Program:
    """Return a target as a program, with the libraries of its package that it links."""
    targets = _target_and_libraries(target, contents)
    return Program(
        name=target.name,
        package=contents.name,
        language=ProgramLanguage.CPP,
        sources=_without_duplicates(path for part in targets for path in part.sources),
        definitions=_without_duplicates(name for part in targets for name in part.definitions),
    )


def script_program(path: Path, contents: PackageContents) -> Program:
    """Return a script as a program."""
    return Program(
        name=path.name, package=contents.name, language=script_language(path), sources=(path,)
    )


def _target_and_libraries(target: BuildTarget, contents: PackageContents) -> list[BuildTarget]:
    """Return a target and the libraries of its package that it links, also through others."""
    libraries = {part.name: part for part in contents.targets if part.kind is TargetKind.LIBRARY}
    libraries |= {
        part.output_name: part for part in libraries.values() if part.output_name not in libraries
    }
    found = {target.name: target}
    waiting = [target]
    while waiting:
        for name in waiting.pop().links:
            library = libraries.get(name)
            if library is not None and library.name not in found:
                found[library.name] = library
                waiting.append(library)
    return list(found.values())


def _without_duplicates(values: Iterable[_T]) -> tuple[_T, ...]:
    return tuple(dict.fromkeys(values))


def find_script(name: str, contents: PackageContents, files: PackageFiles) -> Path | None:
    """Return the script of this name, an installed one first.

    Files must be executable, unless the package keeps no modes: then no file of it is.
    """
    installed = dict(contents.installed_scripts).get(name)
    if installed is not None:
        return installed
    found = [path for path in files.files_named(name) if files.is_file(path)]
    runnable = [path for path in found if is_executable(path)]
    if not runnable and found and not has_executable_files(files):
        runnable = [path for path in found if script_language(path) is not ProgramLanguage.OTHER]
    return min(runnable, key=lambda path: _folder_rank(path, files.folder), default=None)


def executable_names(files: PackageFiles) -> tuple[str, ...]:
    """Return the names of the executable files of a package."""
    found = (files.folder / name for name in files.names)
    return tuple(path.name for path in found if is_executable(path))


def has_executable_files(files: PackageFiles) -> bool:
    """Return whether any file of a package is executable."""
    return any(is_executable(files.folder / name) for name in files.names)


def is_executable(path: Path) -> bool:
    """Return whether any user may execute a file."""
    try:
        return bool(path.stat().st_mode & 0o111)
    except OSError:
        return False


def script_language(path: Path) -> ProgramLanguage:
    """Return what a script is written in, by its first line or its name's ending."""
    try:
        with path.open("rb") as stream:
            start = stream.read(_SHEBANG_BYTES)
    except OSError:
        return ProgramLanguage.OTHER
    shebang = _SHEBANG.match(start)
    if shebang is None:
        return _SUFFIXES.get(path.suffix, ProgramLanguage.OTHER)
    return ProgramLanguage.PYTHON if shebang[1] == b"python" else ProgramLanguage.SHELL


def _folder_rank(path: Path, folder: Path) -> tuple[int, int, str]:
    parts = path.relative_to(folder).parts
    ranks = [rank for rank, name in enumerate(_PREFERRED) if name in parts]
    return (min(ranks, default=len(_PREFERRED)), len(parts), str(path))


def program_digest(program: Program) -> str:
    """Return a hash over a program's files, definitions and language, in hexadecimal.

    A file that cannot be read counts by its name alone.
    """
    digest = hashlib.sha256()
    for text in (program.language, program.package, program.name, *program.definitions):
        digest.update(f"{text}\0".encode("utf-8", "surrogateescape"))
    for path in program.sources:
        digest.update(str(path).encode("utf-8", "surrogateescape") + content_hash(path).encode())
    return digest.hexdigest()
