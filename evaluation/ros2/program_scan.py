"""All programs of a ROS 2 workspace, scanned without a launch.

Each is a node with the name that its source gives it.
"""

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.declaration import NodeSite
from rtron.sources.static.common.cache import hash_workspace, open_cache
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import (
    InterpretationTask,
    TaskKind,
    TaskResult,
    component_task,
    executable_task,
)
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.workspace import Workspace
from rtron.sources.workspace.package_contents import TargetKind

_MAX_SOURCE = 16 * 2**20

_TESTS = frozenset({"test", "tests", "benchmark", "example", "examples"})


def ros2_programs(workspace: Workspace, folder: Path) -> Iterator[tuple[str, InterpretationTask]]:
    """Yield the executables and components of the packages below a folder, with their package.

    A component that an executable of its package makes is that executable's. The packages that
    use most others come first, since their programs take longest.
    """
    packages = [
        package for package, path in workspace.packages.items() if path.is_relative_to(folder)
    ]

    def used(package: str) -> int:
        return sum(name in workspace.packages for name in workspace.manifest(package).depends)

    for package in sorted(packages, key=used, reverse=True):
        for task in _package_tasks(workspace, package):
            yield package, task


def _default_site(name: str) -> NodeSite:
    """Return where a program runs of which no launch is known."""
    return NodeSite(
        name=f"/{name}",
        ros=2,
        has_launch_name=False,
        has_launch_namespace=False,
        parameters_complete=False,
    )


def _package_tasks(workspace: Workspace, package: str) -> Iterator[InterpretationTask]:
    tasks = [
        task
        for name in _executables(workspace, package)
        for task in _executable_tasks(workspace, package, name)
    ]
    yield from tasks
    contents = workspace.contents(package)
    executable_sources = {
        path for task in tasks if task.kind is TaskKind.CPP for path in task.sources
    }
    running = {task.class_name for task in tasks}
    for component in contents.components if contents else ():
        plain = component.class_name.rpartition("::")[2]
        task = component_task(workspace, package, component.class_name, _default_site(plain))
        if (
            task
            and component.class_name not in running
            and not _is_created(component.class_name, executable_sources, task)
        ):
            yield task


def _is_created(cls: str, sources: set[Path], task: InterpretationTask) -> bool:
    """Tell whether the source of an executable, beside those of the component, names its class."""
    plain = cls.rpartition("::")[2].encode()
    return any(plain in _source_bytes(path) for path in sources - set(task.sources))


def _source_bytes(path: Path) -> bytes:
    try:
        return read_regular_file(path, _MAX_SOURCE)
    except InputError:
        return b""


def _executables(workspace: Workspace, package: str) -> Iterator[str]:
    contents = workspace.contents(package)
    for target in contents.targets if contents else ():
        if target.kind is TargetKind.EXECUTABLE and not _is_test(target.sources, contents.path):  # type: ignore[union-attr]
            yield target.name
    for component in contents.components if contents else ():
        if component.executable:
            yield component.executable
    for name, _ in contents.installed_scripts if contents else ():
        yield name
    yield from workspace.entry_points(package)


def _is_test(sources: tuple[Path, ...], package: Path) -> bool:
    return any(_TESTS & set(path.relative_to(package).parts[:-1]) for path in sources[:1])


def _executable_tasks(
    workspace: Workspace, package: str, name: str
) -> Iterator[InterpretationTask]:
    task = executable_task(workspace, package, name, _default_site(name))
    if task is not None and task.sources:
        yield task


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramScan:
    """A program of a package, and what came of it."""

    package: str
    task: InterpretationTask
    result: TaskResult


def scan_programs(
    workspace: Workspace, folder: Path, options: ScanOptions
) -> Iterator[ProgramScan]:
    """Yield the executables and components of the packages below a folder, as they are done."""
    cache = open_cache(options.cache, hash_workspace(workspace))
    packages: dict[int, str] = {}
    missing: list[InterpretationTask] = []
    for package, task in ros2_programs(workspace, folder):
        cached = cache.get(task)
        if cached is not None:
            yield ProgramScan(package=package, task=task, result=cached)
            continue
        packages[id(task)] = package
        missing.append(task)
    with closing(WorkerPool(workspace, options.workers, options.seconds)) as pool:
        for task, result in pool.run_tasks(missing):
            cache.put(task, result)
            yield ProgramScan(package=packages[id(task)], task=task, result=result)
