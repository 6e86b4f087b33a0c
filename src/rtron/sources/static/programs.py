"""Every program of a workspace, each to be interpreted as a node that no launch file starts."""

from collections.abc import Iterator
from pathlib import Path

from rtron.sources.declaration import NodeSite
from rtron.sources.static.common.task import Task, TaskKind
from rtron.sources.workspace import Language, Program, Workspace
from rtron.sources.workspace.catalog import NODELET
from rtron.sources.workspace.package_contents import TargetKind
from rtron.sources.workspace.scripts import is_executable, language


def programs(workspace: Workspace, folder: Path) -> Iterator[tuple[str, Task]]:
    """Yield the executables, executable Python scripts and nodelets below a folder.

    Each comes with the name of its package.
    """
    packages = [p for p, path in workspace.packages.items() if path.is_relative_to(folder)]
    for package in packages:
        for task in (*_executables(workspace, package), *_scripts(workspace, package)):
            yield package, task
    for plugin in workspace.plugins(NODELET):
        found = workspace.nodelet(plugin.name or plugin.type)
        if plugin.package in packages and found and found.program:
            yield plugin.package, _task(TaskKind.NODELET, found.program, cls=plugin.type)


def _executables(workspace: Workspace, package: str) -> Iterator[Task]:
    contents = workspace.contents(package)
    for target in contents.targets if contents else ():
        if target.kind is TargetKind.EXECUTABLE:
            program = workspace.executable(package, target.name)
            if program and program.language is Language.CPP and program.sources:
                yield _task(TaskKind.CPP, program)


def _scripts(workspace: Workspace, package: str) -> Iterator[Task]:
    files = workspace.files(package)
    for path in (files.folder / name for name in files.names):
        if files.is_file(path) and is_executable(path) and language(path) is Language.PYTHON:
            site = NodeSite(name=f"/{path.stem}", complete=False)
            yield Task(kind=TaskKind.PYTHON, sources=(path,), site=site)


def _task(kind: TaskKind, program: Program, *, cls: str = "") -> Task:
    name = cls.rpartition(":")[2].rpartition("/")[2] or program.name
    site = NodeSite(name=f"/{name}", complete=False)
    return Task(kind=kind, sources=program.sources, cls=cls, site=site)
