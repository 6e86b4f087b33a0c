"""Sorts the launch files that nodes start: which can be guarded, and with which programs."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.planning.instrument.common.remaps import NodeRemaps
from rtron.planning.instrument.ros1.launch_copies import Edits, LaunchCopies
from rtron.planning.instrument.ros1.runtime_launch import (
    STARTER_SCRIPT,
    PackageFile,
    RuntimeLaunchTree,
    find_modules,
    find_package_file,
    find_scripts,
    merge_launches,
    starter_nodes,
)
from rtron.vocabulary import LaunchNode, LaunchTree

_MAX_BYTES = 4 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class ReachCheck:
    """Looks at started launch files; `overlay_files` are the programs that run from the overlay."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class ReachableLaunches:
    """What is reached and by which scripts and modules; `unreachable` says why a node is not."""

    started: tuple[RuntimeLaunchTree, ...] = ()
    unreachable: Mapping[LaunchNode, str] = field(default_factory=dict)
    starters: frozenset[str] = frozenset()
    programs: Mapping[PackageFile, LaunchNode] = field(default_factory=dict)
    modules: frozenset[PackageFile] = frozenset()


def find_reachable_launches(
    tree: LaunchTree,
    started: Sequence[RuntimeLaunchTree],
    remaps: NodeRemaps,
    packages: Mapping[str, Path],
) -> ReachableLaunches:
    """Return which started launch files can be guarded in an overlay of their packages."""
    app, names = merge_launches(tree, started), starter_nodes(started, remaps)
    programs = find_scripts((node for node in app.nodes() if node.name in names), packages)
    modules = frozenset(find_modules(started, programs))
    check = ReachCheck(app, frozenset({*programs, *modules}))
    problems = dict(
        _launch_problems(started, check, LaunchCopies(remaps, dict.fromkeys(names, STARTER_SCRIPT)))
    )
    problems |= _unreachable_starters(tree, started, problems)
    launches = tuple(one for number, one in enumerate(started) if number not in problems)
    unreachable = {node: problems[n] for n in sorted(problems) for node in started[n].tree.nodes()}
    names = starter_nodes(
        launches, {node: remaps[node] for node in remaps if node not in unreachable}
    )
    programs = {script: node for script, node in programs.items() if node.name in names}
    return ReachableLaunches(
        started=launches,
        unreachable=unreachable,
        starters=names,
        programs=programs,
        modules=frozenset(find_modules(launches, programs)) - set(programs),
    )


def _launch_problems(
    started: Sequence[RuntimeLaunchTree], check: ReachCheck, copies: LaunchCopies
) -> Iterator[tuple[int, str]]:
    """Yield what speaks against each started launch; one file can have one copy only."""
    edits: dict[Path, Edits] = {}
    for number, one in enumerate(started):
        required = copies.edits(one.tree.root)
        problem = check.problem(one)
        if problem is None and edits.setdefault(one.path, required) != required:
            problem = f"{one.path} is started in several ways that need other remaps"
        if problem is not None:
            yield number, problem


def _unreachable_starters(
    tree: LaunchTree, started: Sequence[RuntimeLaunchTree], problems: Mapping[int, str]
) -> dict[int, str]:
    """Return the launches whose starters themselves come from launches that are not reached."""
    found = dict(problems)
    for _ in started:
        trees = [one.tree for number, one in enumerate(started) if number not in found]
        names = Counter(node.name for one in (tree, *trees) for node in one.nodes())
        for number, one in enumerate(started):
            if not names[one.starter]:
                why = f"{one.starter} starts {one.path}, and is itself started out of reach"
                found.setdefault(number, why)
    return found
