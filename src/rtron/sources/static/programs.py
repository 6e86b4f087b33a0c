"""Every program of a workspace, each to be interpreted as a node that no launch file starts."""

from collections.abc import Iterator
from pathlib import Path

from rtron.sources.declaration import NodeSite
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.sources.workspace import Program, ProgramLanguage, Workspace
from rtron.sources.workspace.catalog import NODELET
from rtron.sources.workspace.package_contents import TargetKind
from rtron.sources.workspace.scripts import is_executable, script_language


def workspace_programs(
    workspace: Workspace, folder: Path
) -> Iterator[tuple[str, InterpretationTask]]:
    """Yield the executables, executable Python scripts and nodelets below a folder.

    Each comes with the name of its package.
    """
    packages = [p for p, path in workspace.packages.items() if path.is_relative_to(folder)]
    for package in packages:
        for task in (*_executables(workspace, package), *_scripts(workspace, package)):
            yield package, task
    for plugin in workspace.plugins(NODELET):
        nodelet = workspace.nodelet(plugin.name or plugin.type)
        if plugin.package in packages and nodelet and nodelet.program:
            yield plugin.package, _task(TaskKind.NODELET, nodelet.program, cls=plugin.type)


def _executables(workspace: Workspace, package: str) -> Iterator[InterpretationTask]:
    contents = workspace.contents(package)
    for target in contents.targets if contents else ():
        if target.kind is TargetKind.EXECUTABLE:
            program = workspace.executable(package, target.name)
            if program and program.language is ProgramLanguage.CPP and program.sources:
                yield _task(TaskKind.CPP, program)


def _scripts(workspace: Workspace, package: str) -> Iterator[InterpretationTask]:
    files = workspace.files(package)
    for path in (files.folder / name for name in files.names):
        if (
            files.is_file(path)
            and is_executable(path)
            and script_language(path) is ProgramLanguage.PYTHON
        ):
            site = NodeSite(name=f"/{path.stem}", parameters_complete=False)
            yield InterpretationTask(kind=TaskKind.PYTHON, sources=(path,), site=site)


def _task(kind: TaskKind, program: Program, *, cls: str = "") -> InterpretationTask:
    name = cls.rpartition(":")[2].rpartition("/")[2] or program.name
    site = NodeSite(name=f"/{name}", parameters_complete=False)
    return InterpretationTask(kind=kind, sources=program.sources, class_name=cls, site=site)
