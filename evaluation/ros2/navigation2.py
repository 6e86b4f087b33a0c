"""Navigation2: which of its calls that join nodes are found, at which node, and in what time.

Every executable and component is scanned without a launch. A call counts as found if a node
declares a name at its line, or within a few of it: a literal one, a parameter's, or one with parts
that only a launch or a message gives. The peer is ros2inspector 0.1.5, run on the same commit: what
it attaches to a node class, of 75 publishers, 60 subscriptions, 28 services and 13 action servers;
its time is that of its scan on the same 2 cores.
"""

import re
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from evaluation.common.datasets import Datasets, Reporter
from evaluation.ros2.call_sites import Site, call_sites
from evaluation.ros2.navigation2_launch import launch_figures
from evaluation.ros2.navigation2_models import model_figures
from evaluation.ros2.program_scan import ProgramScan, scan_programs
from figures.figure import Figure
from rtron.sources.declaration import Declaration
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import read_ros2_workspace

NEAR = 2
"""Lines between where a call begins and where it is said to be."""

_REPOSITORY = "ros-navigation/navigation2@a3a97043"
_PERCENT = 100
_NOTHING = re.compile(r"\{\?\}")
_PEER = {
    "publisher": 22 / 75,
    "subscription": 10 / 60,
    "service": 12 / 28,
    "action server": 12 / 13,
}
_PEER_SECONDS = 10.9
_NOT_NODES = ("nav2_system_tests", "nav2_rviz_plugins")


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Scan all programs with an empty cache and with a full one, and look for each call."""
    (folder,) = datasets.repositories([_REPOSITORY])
    with tempfile.TemporaryDirectory(prefix="rtron-eval-") as name:
        options = ScanOptions(cache=Path(name) / "cache")
        reporter.progress("navigation2, cold")
        found, cold = _scanned(folder, options)
        reporter.progress("navigation2, warm")
        _, warm = _scanned(folder, options)
        reporter.progress("navigation2, launched")
        launched = list(launch_figures(folder, options, reporter))
        reporter.progress("navigation2, its models")
        launched += model_figures(folder, options, reporter)
    yield from call_site_figures("nav2", call_sites(folder), found, reporter, _PEER)
    yield Figure("nav2.cold", cold, _PEER_SECONDS, "s", at_most=6)
    yield Figure("nav2.warm", warm, None, "s", at_most=1)
    yield from launched


def _scanned(folder: Path, options: ScanOptions) -> tuple[Sequence[ProgramScan], float]:
    before = time.perf_counter()
    found = list(scan_programs(read_ros2_workspace([folder]), folder, options))
    return found, time.perf_counter() - before


def call_site_figures(
    name: str,
    sites: Mapping[str, frozenset[Site]],
    programs: Sequence[ProgramScan],
    reporter: Reporter,
    peer: Mapping[str, float] = MappingProxyType({}),
) -> Iterator[Figure]:
    """Yield the share of each kind of call that a node declares a name at, beside a peer's.

    Where there is a peer, nine tenths are asked for.
    """
    declared = [d for one in programs if one.package not in _NOT_NODES for d in _named(one)]
    nodes = {d.node for d in declared}
    how = Counter(d.resolution.value for d in declared)
    shown = ", ".join(f"{count} {label}" for label, count in sorted(how.items()))
    reporter.lines([f"{name}: {len(programs)} programs, {len(nodes)} nodes, names: {shown}"])
    locations = {(location.file, location.line) for d in declared for location in d.evidence}
    for kind, found in sites.items():
        missed = sorted(site for site in found if not _is_near(site, locations))
        reporter.lines([f"  {len(found)} {kind} calls, {len(missed)} of them not found"])
        reporter.detail([f"  MISSED {kind} {file}:{line}" for file, line in missed])
        share = _PERCENT * (1 - len(missed) / max(1, len(found)))
        theirs = _PERCENT * peer[kind] if kind in peer else None
        bound = 90 if kind in peer else None
        unit = f"% of {kind} calls"
        yield Figure(f"{name}.{kind.replace(' ', '_')}", share, theirs, unit, at_least=bound)


def _named(one: ProgramScan) -> Iterator[Declaration]:
    """Yield what a program's nodes declare of themselves, if something is told of its name."""
    for declared in one.result.interface.declarations:
        if not declared.implicit and declared.node and not _NOTHING.search(declared.name):
            yield declared


def _is_near(site: Site, locations: set[Site]) -> bool:
    file, line = site
    return any((file, line + away) in locations for away in range(-NEAR, NEAR + 1))
