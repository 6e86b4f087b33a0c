"""One program to be interpreted as one node; a task travels to a worker process and back."""

from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.bounded_file import content_hash
from rtron.sources.code.interpreter.execution.source_provider import Files, Plugin
from rtron.sources.code.ir import Language, Unit
from rtron.sources.code.program_runner import run_component, run_cpp, run_nodelet, run_python
from rtron.sources.code.shell_script import read_shell
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.vocabulary import Word


class TaskKind(Word):
    """How a program is run."""

    CPP = "cpp"
    PYTHON = "python"
    SHELL = "sh"
    NODELET = "nodelet"
    COMPONENT = "component"


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A program's sources, macros and the node it runs as.

    `cls` is a nodelet's or component's class, or the function that a Python module is entered by.
    `beside` are the other components of its package, which it does not run.
    """

    kind: TaskKind
    sources: tuple[Path, ...]
    cls: str = ""
    definitions: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    site: NodeSite


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskResult:
    """What a node declares, and each file that was read for it with its content's hash."""

    interface: NodeInterface
    files: tuple[tuple[str, str], ...] = ()


def run_task(task: Task, files: WorkspaceFiles) -> TaskResult:
    """Return what a task's program declares."""
    watched = WatchedFiles(files.defining(task.definitions))
    interface = _run(task, watched)
    read = dict.fromkeys((*task.sources, *watched.read))
    hashes = tuple((str(path), content_hash(path)) for path in read)
    return TaskResult(interface=interface, files=hashes)


def _run(task: Task, files: Files) -> NodeInterface:
    if task.kind is TaskKind.SHELL:
        return read_shell(task.sources[0])
    if task.kind is TaskKind.PYTHON:
        return run_python(task.sources[0], task.site, files, task.cls)
    if task.kind is TaskKind.COMPONENT:
        return run_component(task.sources, task.cls, task.site, files, task.beside)
    if task.kind is TaskKind.NODELET:
        return run_nodelet(task.sources, task.cls, task.site, files)
    return run_cpp(task.sources, task.site, files)


@dataclass(slots=True)
class WatchedFiles:
    """The files around a program, noting which of them are read."""

    files: Files
    read: dict[Path, None] = field(default_factory=dict)

    def unit(self, path: Path, language: Language) -> Unit:
        """Return a file, lowered."""
        self.read[path] = None
        return self.files.unit(path, language)

    def header(self, include: str, includer: Path) -> Path | None:
        """Return the file that `#include` means."""
        return self.files.header(include, includer)

    def python_module(self, dotted: str, importer: Path) -> Path | None:
        """Return the file of a Python module."""
        return self.files.python_module(dotted, importer)

    def has_message(self, package: str, name: str) -> bool | None:
        """Tell whether a package defines a message type."""
        return self.files.has_message(package, name)

    def package_path(self, package: str) -> Path | None:
        """Return where a package lies."""
        return self.files.package_path(package)

    def text(self, path: Path) -> str | None:
        """Return a data file of the workspace."""
        self.read[path] = None
        return self.files.text(path)

    def plugin(self, name: str, base: str) -> Plugin | None:
        """Return the class that pluginlib knows by a name or type."""
        return self.files.plugin(name, base)

    def plugins(self, base: str) -> tuple[str, ...]:
        """Return the names of all plugins of a base class."""
        return self.files.plugins(base)

    def library(self, name: str) -> tuple[Path, ...]:
        """Return the sources of the library that a file name means."""
        return self.files.library(name)

    def libraries_naming(self, word: str) -> tuple[tuple[Path, ...], ...]:
        """Return the sources of each library that has a word in one of them."""
        return self.files.libraries_naming(word)

    def naming(self, sources: tuple[Path, ...], word: str) -> tuple[Path, ...]:
        """Return those of some sources whose text has a word."""
        return self.files.naming(sources, word)

    def implementing(self, header: Path, word: str) -> tuple[Path, ...]:
        """Return the sources of a header's package that may define a class or function."""
        return self.files.implementing(header, word)
