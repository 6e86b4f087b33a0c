"""Which of the launch files that nodes start an overlay of their packages reaches."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.planning.instrument.ros1.package_files import PackageFile, find_package_file
from rtron.planning.instrument.ros1.runtime_launch import RuntimeLaunchTree
from rtron.vocabulary import LaunchNode, LaunchTree

_MAX_BYTES = 4 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class ReachCheck:
    """Looks at started launch files; `overlay_files` are the programs' files that run from the overlay."""

    tree: LaunchTree
    overlay_files: frozenset[PackageFile]

    def problem(self, started: RuntimeLaunchTree) -> str | None:
        """Return why a started launch file cannot be replaced by a copy; None if it can."""
        return next(self._problems(started), None)

    def _problems(self, started: RuntimeLaunchTree) -> Iterator[str]:
        package_file = find_package_file(started.path)
        starters = [node for node in self.tree.nodes() if node.name == started.starter]
        named = f"{started.starter} starts {started.path}"
        if package_file is None:
            yield f"{named}, which lies in no package"
            return
        if not starters:
            yield f"{named}, and no launch file starts {started.starter}"
        for source in self._passed_paths(started, starters):
            yield f"{named}, a path that it is given by {source}"
        for evidence in started.evidence:
            yield from self._path_literals(named, evidence.file, package_file)

    def _passed_paths(
        self, started: RuntimeLaunchTree, starters: list[LaunchNode]
    ) -> Iterator[str]:
        """Yield the arguments and parameters that roslaunch fills with the original's path."""
        for node in starters:
            if _contains_path(node.args, started.path):
                yield "its arguments"
            yield from (
                f"${name}" for name, value in node.environ if _contains_path(value, started.path)
            )
        for name, parameter in self.tree.parameters.leaves.items():
            if _contains_path(str(parameter.value), started.path):
                yield f"the parameter {name}"

    def _path_literals(self, named: str, file: str, package_file: PackageFile) -> Iterator[str]:
        """Yield what a program's text says of absolute paths and of its own place."""
        text = _text(Path(file))
        if f"{package_file.package.parent}/" in text:
            yield f"{named}, a path that {file} has as it is"
        program_file = find_package_file(Path(file))
        if "__file__" in text and program_file not in self.overlay_files:
            yield f"{named} by the place of {file}, which is not beside its program"


def _contains_path(text: str, path: Path) -> bool:
    """Tell whether a text has a path from the file's package on towards the file."""
    package_file = find_package_file(path)
    if package_file is None:
        return False
    package = str(path.parents[len(package_file.relative_path.parts) - 1])
    found = re.findall(rf"{re.escape(package)}[^\s\"':;,]*", text)
    return any(str(path).startswith(one) for one in found)


def _text(path: Path) -> str:
    if not path.is_file():
        return ""
    try:
        with path.open("rb") as file:
            return file.read(_MAX_BYTES).decode("utf-8", "replace")
    except OSError:
        return ""
