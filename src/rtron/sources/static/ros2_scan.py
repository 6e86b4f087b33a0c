"""Interprets all programs of ROS 2 packages, without a launch: what each node declares at least."""

from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from rtron.sources.launch.common.packages import find_packages
from rtron.sources.static.common.cache import open_cache
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import Task, TaskResult
from rtron.sources.static.common.worker_pool import Pool
from rtron.sources.static.common.workspace_hash import workspace_state
from rtron.sources.static.ros2.programs import ros2_programs
from rtron.sources.workspace import Workspace


@dataclass(frozen=True, slots=True, kw_only=True)
class ScannedProgram:
    """A program of a package, and what came of it."""

    package: str
    task: Task
    result: TaskResult


def ros2_workspace(folders: Iterable[Path]) -> Workspace:
    """Return the packages below folders alone: Debian's are of ROS 1."""
    given = tuple(folder.absolute() for folder in folders)
    found = find_packages(given, {})
    ours = {n: path for n, path in found.items() if any(map(path.is_relative_to, given))}
    return Workspace(ours, given)


def scan_programs(
    workspace: Workspace, folder: Path, options: ScanOptions
) -> Iterator[ScannedProgram]:
    """Yield the executables and components of the packages below a folder, as they are done."""
    cache = open_cache(options.cache, workspace_state(workspace))
    packages: dict[int, str] = {}
    missing: list[Task] = []
    for package, task in ros2_programs(workspace, folder):
        known = cache.get(task)
        if known is not None:
            yield ScannedProgram(package=package, task=task, result=known)
            continue
        packages[id(task)] = package
        missing.append(task)
    with closing(Pool(workspace, options.workers, options.seconds)) as pool:
        for task, result in pool.run(missing):
            cache.put(task, result)
            yield ScannedProgram(package=packages[id(task)], task=task, result=result)
