"""A first model of a node, drafted from its source for somebody to check (docs/models.md)."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import Declaration, NodeInterface, NodeSite
from rtron.sources.models.common.schema import ANY_TYPE
from rtron.sources.static.common.task import Task, TaskKind, run_task
from rtron.sources.workspace import Language, Program, Workspace
from rtron.sources.workspace.package_contents import TargetKind
from rtron.vocabulary import Evidence, Resolution, Unresolved

_NAMESPACE = "/rtron_namespace"
_NODE = f"{_NAMESPACE}/rtron_node"
_HOLE = re.compile(r"\{([^{}]*)\}")
_PARAMETER = re.compile(r"[~/][\w/]+")
_PLAIN = re.compile(r"[A-Za-z~/][\w~/]*")
_DEFAULTED = "  # a parameter's default, or the launch, decides this name"
_INTERPRETED = {Language.CPP: TaskKind.CPP, Language.PYTHON: TaskKind.PYTHON}


@dataclass(frozen=True, slots=True)
class Draft:
    """A model's YAML, and what of the source could not be found out."""

    text: str
    unresolved: tuple[Unresolved, ...] = ()


def draft_model(path: Path, workspace: Workspace) -> Draft:
    """Return a model of the program that a source file belongs to.

    Raise InputError if the file is part of no program that is C++ or Python.
    """
    path = path.absolute()
    package = workspace.package_of(path) or ""
    program = _program_of(path, package, workspace)
    kind = _INTERPRETED[program.language]
    task = Task(kind=kind, sources=program.sources, site=NodeSite(name=_NODE, complete=False))
    found = run_task(task, WorkspaceFiles(workspace)).interface
    folder = workspace.packages.get(package, path.parent)
    own = _relative(str(path), folder)
    lines = [
        "# A draft from source: check every entry, name the repository and its tag.",
        f"node: {_word(f'{package or path.parent.name}/{program.name}')}",
        f"source: github.com/OWNER/NAME@TAG {own}",
        "declares:" if found.declarations else "declares: []",
        *_entries(found, own, folder),
    ]
    return Draft("\n".join(lines) + "\n", found.unresolved)


def _program_of(path: Path, package: str, workspace: Workspace) -> Program:
    contents = workspace.contents(package)
    targets = contents.targets if contents else ()
    for target in targets:
        if target.kind is TargetKind.EXECUTABLE and path in target.sources:
            program = workspace.executable(package, target.name)
            if program is not None:
                return program
    script = workspace.executable(package, path.name)
    if script is not None and script.sources == (path,) and script.language in _INTERPRETED:
        return script
    language = {".py": Language.PYTHON, ".cpp": Language.CPP, ".cc": Language.CPP}.get(path.suffix)
    if language is None or not path.is_file():
        help = "give a node's script, or the source with its main function"
        raise InputError("is no program's source", path=str(path), help=help)
    name = path.name if language is Language.PYTHON else path.stem
    return Program(name=name, package=package, language=language, sources=(path,))


def _entries(found: NodeInterface, own: str, folder: Path) -> Iterator[str]:
    for declared in found.declarations:
        place = _place(next(iter(declared.evidence), Evidence(file="")), own, folder)
        yield _entry(declared, place)


def _entry(declared: Declaration, place: list[str]) -> str:
    name = _template(declared.name)
    if name is None:
        spelled = declared.name.replace("{", "<").replace("}", ">").removeprefix(_NAMESPACE)
        parts = [f"unresolved: {_word(f'{declared.kind.value} {spelled}')}"]
        parts.append(f"why: {_word('its name is not known from the source')}")
        return "- {" + ", ".join((*parts, *place)) + "}"
    parts = [f"{declared.kind.value}: {_word(name)}", f"type: {_word(declared.type or ANY_TYPE)}"]
    parts += ["implicit: true"] if declared.implicit else []
    parts += ["latched: true"] if declared.latched else []
    note = _DEFAULTED if declared.resolution is Resolution.PARAMETER else ""
    return "- {" + ", ".join((*parts, *place)) + "}" + note


def _template(name: str) -> str | None:
    """Return a name as a model writes it; None where a hole in it is no parameter."""
    holes = _HOLE.findall(name)
    if not all(map(_PARAMETER.fullmatch, holes)):
        return None
    pieces = _HOLE.split(_local(_HOLE.sub("{_}", name)))
    filled = map(_local, holes)
    return "".join(f"{{param('{next(filled)}')}}" if i % 2 else p for i, p in enumerate(pieces))


def _local(name: str) -> str:
    """Return an absolute name as the node itself would write it."""
    for below, written in ((f"{_NODE}/", "~"), (f"{_NAMESPACE}/", "")):
        if name.startswith(below):
            return written + name.removeprefix(below)
    return name


def _place(evidence: Evidence, own: str, folder: Path) -> list[str]:
    if not evidence.file or not evidence.line:
        return []
    file = _relative(evidence.file, folder)
    return (
        [f"line: {evidence.line}"] if file == own else [f"at: {_word(f'{file}:{evidence.line}')}"]
    )


def _relative(file: str, folder: Path) -> str:
    path = Path(file)
    inside = path.relative_to(folder) if path.is_relative_to(folder) else Path(path.name)
    return re.sub(r"[^\w./-]", "_", str(inside))


def _word(text: str) -> str:
    return text if _PLAIN.fullmatch(text) else json.dumps(text)
