"""Sorts the launch files that nodes start: which can be guarded, and with which programs."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.planning.instrument.common.remaps import NodeRemaps
from rtron.planning.instrument.ros1.launch_copies import Edits, LaunchCopies
from rtron.planning.instrument.ros1.package_files import PackageFile
from rtron.planning.instrument.ros1.programs import find_modules, find_scripts
from rtron.planning.instrument.ros1.reach import ReachCheck
from rtron.planning.instrument.ros1.runtime_launch import (
    RuntimeLaunchTree,
    merge_launches,
    starter_nodes,
)
from rtron.vocabulary import LaunchNode, LaunchTree


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
    problems = dict(_launch_problems(started, check, LaunchCopies(remaps, names)))
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
