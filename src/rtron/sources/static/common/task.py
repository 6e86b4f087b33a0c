"""One program to be interpreted as one node; a task travels to a worker process and back."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.bounded_file import content_hash
from rtron.sources.code import ir
from rtron.sources.code.interpreter.execution.source_provider import PluginSource, SourceProvider
from rtron.sources.code.program_runner import (
    run_component,
    run_cpp,
    run_hardware,
    run_nodelet,
    run_plugin,
    run_python,
    run_sketch,
)
from rtron.sources.code.shell_script import read_shell_script
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.sources.workspace import Program, ProgramLanguage, Workspace
from rtron.vocabulary import StringEnum


class TaskKind(StringEnum):
    """How a program is run."""

    CPP = "cpp"
    PYTHON = "python"
    SHELL = "sh"
    NODELET = "nodelet"
    COMPONENT = "component"
    HARDWARE = "hardware"
    PLUGIN = "plugin"
    SKETCH = "sketch"


@dataclass(frozen=True, slots=True, kw_only=True)
class InterpretationTask:
    """A program's sources, macros and the node it runs as.

    `class_name` is a nodelet's, component's or plugin's class, or the function that a Python module
    is entered by. `other_components` are others of its package, which it does not run.
    """

    kind: TaskKind
    sources: tuple[Path, ...]
    class_name: str = ""
    definitions: tuple[str, ...] = ()
    other_components: tuple[str, ...] = ()
    site: NodeSite


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskResult:
    """What a node declares, and each file that was read for it with its content's hash."""

    interface: NodeInterface
    files: tuple[tuple[str, str], ...] = ()


def executable_task(
    workspace: Workspace, package: str, executable: str, site: NodeSite
) -> InterpretationTask | None:
    """Return the task of `<node pkg=… exec=…>` at a site; None where its source is not here."""
    program = workspace.executable(package, executable)
    return _task(workspace, package, program, site) if program is not None else None


def component_task(
    workspace: Workspace, package: str, cls: str, site: NodeSite
) -> InterpretationTask | None:
    """Return the task of `<composable_node pkg=… plugin=…>` at a site, None without its source."""
    program = workspace.component(package, cls)
    return _task(workspace, package, program, site) if program is not None else None


def _task(
    workspace: Workspace, package: str, program: Program, site: NodeSite
) -> InterpretationTask | None:
    kinds = {ProgramLanguage.PYTHON: TaskKind.PYTHON, ProgramLanguage.CPP: TaskKind.CPP}
    kind = kinds.get(program.language)
    if kind is None or not program.sources:
        return None
    if program.entry and kind is TaskKind.CPP:
        kind = TaskKind.COMPONENT
    return InterpretationTask(
        kind=kind,
        sources=program.sources,
        class_name=program.entry,
        definitions=program.definitions,
        other_components=_other_components(workspace, package, program),
        site=site,
    )


def _other_components(workspace: Workspace, package: str, program: Program) -> tuple[str, ...]:
    """Return the other components of a package: what they join is for whoever loads them."""
    contents = workspace.contents(package) if program.entry else None
    classes = [component.class_name for component in contents.components] if contents else []
    return tuple(cls for cls in classes if cls != program.entry)


def run_task(task: InterpretationTask, files: WorkspaceSources) -> TaskResult:
    """Return what a task's program declares."""
    tracked = TrackedFiles(files.with_macros(task.definitions))
    interface = _run(task, tracked)
    paths = dict.fromkeys((*task.sources, *tracked.paths_read))
    hashes = tuple((str(path), content_hash(path)) for path in paths)
    return TaskResult(interface=interface, files=hashes)


_CLASS_RUNNERS: Mapping[TaskKind, Callable[..., NodeInterface]] = {
    TaskKind.COMPONENT: run_component,
    TaskKind.HARDWARE: run_hardware,
    TaskKind.PLUGIN: run_plugin,
}


def _run(task: InterpretationTask, files: SourceProvider) -> NodeInterface:
    if task.kind is TaskKind.SHELL:
        return read_shell_script(task.sources[0])
    if task.kind is TaskKind.PYTHON:
        return run_python(task.sources[0], task.site, files, task.class_name)
    if task.kind in _CLASS_RUNNERS:
        run = _CLASS_RUNNERS[task.kind]
        return run(task.sources, task.class_name, task.site, files, task.other_components)
    if task.kind is TaskKind.NODELET:
        return run_nodelet(task.sources, task.class_name, task.site, files)
    run = run_sketch if task.kind is TaskKind.SKETCH else run_cpp
    return run(task.sources, task.site, files)


@dataclass(slots=True)
class TrackedFiles:
    """The files around a program, noting which of them are read."""

    files: SourceProvider
    paths_read: dict[Path, None] = field(default_factory=dict)

    def lowered_unit(self, path: Path, language: ir.SourceLanguage) -> ir.Unit:
        """Return a file, lowered."""
        self.paths_read[path] = None
        return self.files.lowered_unit(path, language)

    def header(self, include: str, includer: Path) -> Path | None:
        """Return the file that `#include` means."""
        return self.files.header(include, includer)

    def python_module(self, dotted: str, importer: Path) -> Path | None:
        """Return the file of a Python module."""
        return self.files.python_module(dotted, importer)

    def has_message_type(self, package: str, name: str) -> bool | None:
        """Tell whether a package defines a message type."""
        return self.files.has_message_type(package, name)

    def package_path(self, package: str) -> Path | None:
        """Return where a package lies."""
        return self.files.package_path(package)

    def package_names(self) -> tuple[str, ...]:
        """Return the names of the packages of the workspace."""
        return self.files.package_names()

    def is_dependency(self, package: str, path: Path) -> bool:
        """Tell whether the package of a file says that it depends on another."""
        return self.files.is_dependency(package, path)

    def read_text(self, path: Path) -> str | None:
        """Return a data file of the workspace."""
        self.paths_read[path] = None
        return self.files.read_text(path)

    def find_plugin(self, name: str, base: str) -> PluginSource | None:
        """Return the class that pluginlib knows by a name or type."""
        return self.files.find_plugin(name, base)

    def is_plugin(self, name: str) -> bool:
        """Tell whether a class of this name or type is registered, for whatever base."""
        return self.files.is_plugin(name)

    def plugin_names(self, base: str) -> tuple[str, ...]:
        """Return the names of all plugins of a base class."""
        return self.files.plugin_names(base)

    def library_sources(self, name: str) -> tuple[Path, ...]:
        """Return the sources of the library that a file name means."""
        return self.files.library_sources(name)

    def libraries_containing(self, word: str) -> tuple[tuple[Path, ...], ...]:
        """Return the sources of each library that has a word in one of them."""
        return self.files.libraries_containing(word)

    def sources_containing(self, sources: tuple[Path, ...], word: str) -> tuple[Path, ...]:
        """Return those of some sources whose text has a word."""
        return self.files.sources_containing(sources, word)

    def sources_defining(self, header: Path, word: str) -> tuple[Path, ...]:
        """Return the sources of a header's package that may define a class or function."""
        return self.files.sources_defining(header, word)
