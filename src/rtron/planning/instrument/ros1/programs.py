"""The scripts that start launch files: they run from the overlay, so that `__file__` is there.

A script is Python, shell or the like; a compiled program finds packages by ROS_PACKAGE_PATH only.
"""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from rtron.folders import walk
from rtron.planning.instrument.ros1.package_files import PackageFile, find_package_file
from rtron.planning.instrument.ros1.runtime_launch import RuntimeLaunchTree
from rtron.vocabulary import LaunchNode

MAX_FILES = 100_000


def find_scripts(
    nodes: Iterable[LaunchNode], packages: Mapping[str, Path]
) -> dict[PackageFile, LaunchNode]:
    """Return the scripts that nodes run, as far as they lie in the nodes' packages."""
    scripts: dict[PackageFile, LaunchNode] = {}
    for node in nodes:
        for path in _find_by_name(packages.get(node.package), node.type):
            script = find_package_file(path)
            if script and _is_script(path):
                scripts.setdefault(script, node)
    return scripts


def find_modules(
    started: Iterable[RuntimeLaunchTree], programs: Iterable[PackageFile]
) -> set[PackageFile]:
    """Return the files beside the programs in which launch files are started."""
    folders = {program.path.parent for program in programs}
    files = {Path(location.file) for one in started for location in one.evidence}
    modules = {find_package_file(file) for file in files if file.is_file()}
    return {location for location in modules if location and location.path.parent in folders}


def _find_by_name(package: Path | None, name: str) -> Iterator[Path]:
    """Yield a package's files of a name, as roslaunch looks for them."""
    if package is None or not name:
        return
    seen = 0
    for folder, subfolders, files in walk(package):
        subfolders[:] = sorted(sub for sub in subfolders if not sub.startswith("."))
        if name in files:
            yield Path(folder, name)
        seen += len(files)
        if seen > MAX_FILES:
            return


def _is_script(path: Path) -> bool:
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return file.read(2) == b"#!"
    except OSError:
        return False
