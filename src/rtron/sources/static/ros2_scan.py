"""Interprets all programs of ROS 2 packages, without a launch: what each node declares at least."""

from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from rtron.sources.launch.common.packages import find_packages
from rtron.sources.static.common.cache import open_cache
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import InterpretationTask, TaskResult
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.static.common.workspace_hash import hash_workspace
from rtron.sources.static.ros2.programs import ros2_programs
from rtron.sources.workspace import Workspace


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramScan:
    """A program of a package, and what came of it."""

    package: str
    task: InterpretationTask
    result: TaskResult


def read_ros2_workspace(folders: Iterable[Path]) -> Workspace:
    """Return the packages below folders alone: Debian's are of ROS 1."""
    folders_read = tuple(folder.absolute() for folder in folders)
    packages = find_packages(folders_read, {})
    own_packages = {
        n: path for n, path in packages.items() if any(map(path.is_relative_to, folders_read))
    }
    return Workspace(own_packages, folders_read)


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
