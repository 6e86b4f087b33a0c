"""The scripts that start launch files: they run from the overlay, so that `__file__` is there.

A script is Python, shell or the like; a compiled program finds packages by ROS_PACKAGE_PATH only.
"""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from rtron.folders import walk
from rtron.planning.instrument.ros1.package_files import PackagePlace, package_place
from rtron.planning.instrument.ros1.runtime_launch import Started
from rtron.vocabulary import LaunchNode

MAX_FILES = 100_000


def programs_of(
    nodes: Iterable[LaunchNode], packages: Mapping[str, Path]
) -> dict[PackagePlace, LaunchNode]:
    """Return the scripts that nodes run, as far as they lie in the nodes' packages."""
    found: dict[PackagePlace, LaunchNode] = {}
    for node in nodes:
        for path in _called(packages.get(node.package), node.type):
            place = package_place(path)
            if place and _is_script(path):
                found.setdefault(place, node)
    return found


def modules_of(started: Iterable[Started], programs: Iterable[PackagePlace]) -> set[PackagePlace]:
    """Return the files beside the programs in which launch files are started."""
    folders = {program.path.parent for program in programs}
    files = {Path(place.file) for one in started for place in one.evidence}
    places = {package_place(file) for file in files if file.is_file()}
    return {place for place in places if place and place.path.parent in folders}


def _called(package: Path | None, name: str) -> Iterator[Path]:
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
