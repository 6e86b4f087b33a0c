"""Which of the launch files that nodes start an overlay of their packages reaches."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.planning.instrument.ros1.package_files import PackagePlace, package_place
from rtron.planning.instrument.ros1.runtime_launch import Started
from rtron.vocabulary import LaunchNode, LaunchTree

_MAX_BYTES = 4 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class Reach:
    """Looks at started launch files; `moved` are the programs' files that run from the overlay."""

    tree: LaunchTree
    moved: frozenset[PackagePlace]

    def fault(self, started: Started) -> str | None:
        """Return why a started launch file cannot be replaced by a copy; None if it can."""
        return next(self._faults(started), None)

    def _faults(self, started: Started) -> Iterator[str]:
        place = package_place(started.path)
        starters = [node for node in self.tree.nodes() if node.name == started.by]
        named = f"{started.by} starts {started.path}"
        if place is None:
            yield f"{named}, which lies in no package"
            return
        if not starters:
            yield f"{named}, and no launch file starts {started.by}"
        for given in self._given(started, starters):
            yield f"{named}, a path that it is given by {given}"
        for evidence in started.evidence:
            yield from self._written(named, evidence.file, place)

    def _given(self, started: Started, starters: list[LaunchNode]) -> Iterator[str]:
        """Yield the arguments and parameters that roslaunch fills with the original's path."""
        for node in starters:
            if _leads(node.args, started.path):
                yield "its arguments"
            yield from (f"${name}" for name, value in node.environ if _leads(value, started.path))
        for name, parameter in self.tree.parameters.leaves.items():
            if _leads(str(parameter.value), started.path):
                yield f"the parameter {name}"

    def _written(self, named: str, file: str, place: PackagePlace) -> Iterator[str]:
        """Yield what a program's text says of absolute paths and of its own place."""
        text = _text(Path(file))
        if f"{place.package.parent}/" in text:
            yield f"{named}, a path that {file} has as it is"
        own = package_place(Path(file))
        if "__file__" in text and own not in self.moved:
            yield f"{named} by the place of {file}, which is not beside its program"


def _leads(text: str, path: Path) -> bool:
    """Tell whether a text has a path from the file's package on towards the file."""
    place = package_place(path)
    if place is None:
        return False
    package = str(path.parents[len(place.below.parts) - 1])
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
