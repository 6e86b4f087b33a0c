"""Makes programs of targets and scripts."""

from collections.abc import Iterable
from pathlib import Path
from typing import TypeVar

from rtron.sources.workspace.package_contents import BuildTarget, PackageContents, TargetKind
from rtron.sources.workspace.program import Program, ProgramLanguage
from rtron.sources.workspace.scripts import script_language

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
