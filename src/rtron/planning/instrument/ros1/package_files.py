"""In which package a file lies, and where that is without links."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from rtron.folders import walk
from rtron.planning.instrument.ros1.runtime_launch import RuntimeLaunchTree
from rtron.vocabulary import LaunchNode

_MANIFESTS = ("package.xml", "manifest.xml")


@dataclass(frozen=True, slots=True)
class PackageFile:
    """A file of a package: the package's real folder, and the file's path below it."""

    package: Path
    relative_path: Path

    @property
    def path(self) -> Path:
        """The file, with no link on the way to its package."""
        return self.package / self.relative_path


def find_package_file(path: Path) -> PackageFile | None:
    """Return where a file lies in its package; None if it lies in none."""
    for folder in path.parents:
        if any((folder / name).is_file() for name in _MANIFESTS):
            return PackageFile(folder.resolve(), path.relative_to(folder))
    return None


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
