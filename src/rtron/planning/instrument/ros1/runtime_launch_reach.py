"""Sorts the launch files that nodes start: which can be guarded, and with which programs."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.planning.instrument.common.remaps import Wiring
from rtron.planning.instrument.ros1.launch_copies import Copies, Edits
from rtron.planning.instrument.ros1.package_files import PackagePlace
from rtron.planning.instrument.ros1.programs import modules_of, programs_of
from rtron.planning.instrument.ros1.reach import Reach
from rtron.planning.instrument.ros1.runtime_launch import Started, starters, whole_app
from rtron.vocabulary import LaunchNode, LaunchTree


@dataclass(frozen=True, slots=True, kw_only=True)
class Reachable:
    """What is reached and by which scripts and modules; `lost` says why a node is not."""

    started: tuple[Started, ...] = ()
    lost: Mapping[LaunchNode, str] = field(default_factory=dict)
    starters: frozenset[str] = frozenset()
    programs: Mapping[PackagePlace, LaunchNode] = field(default_factory=dict)
    modules: frozenset[PackagePlace] = frozenset()


def reachable(
    tree: LaunchTree, started: Sequence[Started], wiring: Wiring, packages: Mapping[str, Path]
) -> Reachable:
    """Return which started launch files can be guarded in an overlay of their packages."""
    whole, names = whole_app(tree, started), starters(started, wiring)
    programs = programs_of((node for node in whole.nodes() if node.name in names), packages)
    modules = frozenset(modules_of(started, programs))
    reach = Reach(whole, frozenset({*programs, *modules}))
    faults = dict(_faults(started, reach, Copies(wiring, names)))
    faults |= _cut_off(tree, started, faults)
    kept = tuple(one for number, one in enumerate(started) if number not in faults)
    lost = {node: faults[n] for n in sorted(faults) for node in started[n].tree.nodes()}
    names = starters(kept, {node: wiring[node] for node in wiring if node not in lost})
    programs = {place: node for place, node in programs.items() if node.name in names}
    return Reachable(
        started=kept,
        lost=lost,
        starters=names,
        programs=programs,
        modules=frozenset(modules_of(kept, programs)) - set(programs),
    )


def _faults(started: Sequence[Started], reach: Reach, copies: Copies) -> Iterator[tuple[int, str]]:
    """Yield what speaks against each started launch; one file can have one copy only."""
    edits: dict[Path, Edits] = {}
    for number, one in enumerate(started):
        wanted = copies.edits(one.tree.root)
        fault = reach.fault(one)
        if fault is None and edits.setdefault(one.path, wanted) != wanted:
            fault = f"{one.path} is started in several ways that need other remaps"
        if fault is not None:
            yield number, fault


def _cut_off(
    tree: LaunchTree, started: Sequence[Started], faults: Mapping[int, str]
) -> dict[int, str]:
    """Return the launches whose starters themselves come from launches that are not reached."""
    found = dict(faults)
    for _ in started:
        kept = [one.tree for number, one in enumerate(started) if number not in found]
        names = Counter(node.name for one in (tree, *kept) for node in one.nodes())
        for number, one in enumerate(started):
            if not names[one.by]:
                why = f"{one.by} starts {one.path}, and is itself started out of reach"
                found.setdefault(number, why)
    return found
