"""A first model of a node, drafted from its source for somebody to check (docs/models.md)."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import Declaration, NodeInterface, NodeSite
from rtron.sources.models.common.schema import ANY_TYPE
from rtron.sources.static.common.task import InterpretationTask, TaskKind, run_task
from rtron.sources.workspace import Program, ProgramLanguage, Workspace
from rtron.sources.workspace.package_contents import TargetKind
from rtron.vocabulary import Evidence, Resolution, UnresolvedItem

_NAMESPACE = "/rtron_namespace"
_NODE = f"{_NAMESPACE}/rtron_node"
_PLACEHOLDER = re.compile(r"\{([^{}]*)\}")
_PARAMETER = re.compile(r"[~/][\w/]+")
_UNQUOTED_WORD = re.compile(r"[A-Za-z~/][\w~/]*")
_DEFAULT_NOTE = "  # a parameter's default, or the launch, decides this name"
_TASK_KINDS = {ProgramLanguage.CPP: TaskKind.CPP, ProgramLanguage.PYTHON: TaskKind.PYTHON}


@dataclass(frozen=True, slots=True)
class ModelDraft:
    """A model's YAML, and what of the source could not be found out."""

    text: str
    unresolved: tuple[UnresolvedItem, ...] = ()


def draft_model(path: Path, workspace: Workspace) -> ModelDraft:
    """Return a model of the program that a source file belongs to.

    Raise InputError if the file is part of no program that is C++ or Python.
    """
    path = path.absolute()
    package = workspace.package_of(path) or ""
    program = _program_of(path, package, workspace)
    kind = _TASK_KINDS[program.language]
    task = InterpretationTask(
        kind=kind, sources=program.sources, site=NodeSite(name=_NODE, parameters_complete=False)
    )
    interface = run_task(task, WorkspaceSources(workspace)).interface
    folder = workspace.packages.get(package, path.parent)
    source_path = _relative(str(path), folder)
    lines = [
        "# A draft from source: check every entry, name the repository and its tag.",
        f"node: {_yaml_word(f'{package or path.parent.name}/{program.name}')}",
        f"source: github.com/OWNER/NAME@TAG {source_path}",
        "declares:" if interface.declarations else "declares: []",
        *_entries(interface, source_path, folder),
    ]
    return ModelDraft("\n".join(lines) + "\n", interface.unresolved)


def _program_of(path: Path, package: str, workspace: Workspace) -> Program:
    contents = workspace.contents(package)
    targets = contents.targets if contents else ()
    for target in targets:
        if target.kind is TargetKind.EXECUTABLE and path in target.sources:
            program = workspace.executable(package, target.name)
            if program is not None:
                return program
    script = workspace.executable(package, path.name)
    if script is not None and script.sources == (path,) and script.language in _TASK_KINDS:
        return script
    language = {
        ".py": ProgramLanguage.PYTHON,
        ".cpp": ProgramLanguage.CPP,
        ".cc": ProgramLanguage.CPP,
    }.get(path.suffix)
    if language is None or not path.is_file():
        help = "give a node's script, or the source with its main function"
        raise InputError("is no program's source", path=str(path), help=help)
    name = path.name if language is ProgramLanguage.PYTHON else path.stem
    return Program(name=name, package=package, language=language, sources=(path,))


def _entries(interface: NodeInterface, source_path: str, folder: Path) -> Iterator[str]:
    for declared in interface.declarations:
        location = _source_location(
            next(iter(declared.evidence), Evidence(file="")), source_path, folder
        )
        yield _entry(declared, location)


def _entry(declared: Declaration, location: list[str]) -> str:
    name = _template(declared.name)
    if name is None:
        shown_name = declared.name.replace("{", "<").replace("}", ">").removeprefix(_NAMESPACE)
        parts = [f"unresolved: {_yaml_word(f'{declared.kind.value} {shown_name}')}"]
        parts.append(f"why: {_yaml_word('its name is not known from the source')}")
        return "- {" + ", ".join((*parts, *location)) + "}"
    parts = [
        f"{declared.kind.value}: {_yaml_word(name)}",
        f"type: {_yaml_word(declared.type or ANY_TYPE)}",
    ]
    parts += ["implicit: true"] if declared.implicit else []
    parts += ["latched: true"] if declared.latched else []
    note = _DEFAULT_NOTE if declared.resolution is Resolution.PARAMETER else ""
    return "- {" + ", ".join((*parts, *location)) + "}" + note


def _template(name: str) -> str | None:
    """Return a name as a model writes it; None if a placeholder in it is not a parameter."""
    placeholders = _PLACEHOLDER.findall(name)
    if not all(map(_PARAMETER.fullmatch, placeholders)):
        return None
    parts = _PLACEHOLDER.split(_relative_name(_PLACEHOLDER.sub("{_}", name)))
    filled = map(_relative_name, placeholders)
    return "".join(f"{{param('{next(filled)}')}}" if i % 2 else p for i, p in enumerate(parts))


def _relative_name(name: str) -> str:
    """Return an absolute name as the node itself would write it."""
    for prefix, replacement in ((f"{_NODE}/", "~"), (f"{_NAMESPACE}/", "")):
        if name.startswith(prefix):
            return replacement + name.removeprefix(prefix)
    return name


def _source_location(evidence: Evidence, source_path: str, folder: Path) -> list[str]:
    if not evidence.file or not evidence.line:
        return []
    file = _relative(evidence.file, folder)
    return (
        [f"line: {evidence.line}"]
        if file == source_path
        else [f"at: {_yaml_word(f'{file}:{evidence.line}')}"]
    )


def _relative(file: str, folder: Path) -> str:
    path = Path(file)
    inside = path.relative_to(folder) if path.is_relative_to(folder) else Path(path.name)
    return re.sub(r"[^\w./-]", "_", str(inside))


def _yaml_word(text: str) -> str:
    return text if _UNQUOTED_WORD.fullmatch(text) else json.dumps(text)
