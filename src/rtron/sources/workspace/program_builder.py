"""Makes programs of targets and scripts."""

from collections.abc import Container, Iterable
from pathlib import Path
from typing import TypeVar

from rtron.sources.workspace.manifest import Manifest
from rtron.sources.workspace.package_contents import BuildTarget, PackageContents, TargetKind
from rtron.sources.workspace.program import Program, ProgramLanguage
from rtron.sources.workspace.scripts import script_language

_T = TypeVar("_T")


def target_program(
    target: BuildTarget, contents: PackageContents, manifest: Manifest, packages: Container[str]
) -> Program:
    """Return a target as a program, with the libraries of its package that it links."""
    targets = _target_and_libraries(target, contents)
    links = _without_duplicates(name for part in targets for name in part.links)
    reachable = _without_duplicates((*links, *contents.required_packages, *manifest.depends))
    return Program(
        name=target.name,
        package=contents.name,
        language=ProgramLanguage.CPP,
        sources=_without_duplicates(path for part in targets for path in part.sources),
        definitions=_without_duplicates(name for part in targets for name in part.definitions),
        links=links,
        reachable_packages=_other_packages(reachable, contents, packages),
    )


def script_program(
    path: Path, contents: PackageContents, manifest: Manifest, packages: Container[str]
) -> Program:
    """Return a script as a program; it may use any package that the manifest names."""
    return Program(
        name=path.name,
        package=contents.name,
        language=script_language(path),
        sources=(path,),
        reachable_packages=_other_packages(
            _without_duplicates((*contents.required_packages, *manifest.depends)),
            contents,
            packages,
        ),
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


def _other_packages(
    names: Iterable[str], contents: PackageContents, packages: Container[str]
) -> tuple[str, ...]:
    return tuple(name for name in names if name in packages and name != contents.name)


def _without_duplicates(values: Iterable[_T]) -> tuple[_T, ...]:
    return tuple(dict.fromkeys(values))
