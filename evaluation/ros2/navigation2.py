"""Navigation2: which of its calls that join nodes are found, at which node, and in what time.

Every executable and component is scanned without a launch. A call counts as found if a node
declares a name at its line, or within a few of it: a literal one, a parameter's, or one with parts
that only a launch or a message gives. Calls that no program has are left out. The peer is
ros2inspector 0.1.5, run on the same commit: what it attaches to a node class, of 75 publishers, 60
subscriptions, 28 services and 13 action servers; its time is that of its scan on the same 2 cores.
"""

import re
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from evaluation.common.datasets import Datasets, Reporter
from evaluation.ros2.call_sites import ParameterSite, Site, call_sites, parameter_sites
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
GOALS = {"nav2": 98, "universe": 95}
"""The shares (%) of the calls of each kind that are to be found."""
_NOTHING = re.compile(r"\{\?\}")
_PEER = {
    "publisher": 22 / 75,
    "subscription": 10 / 60,
    "service": 12 / 28,
    "action server": 12 / 13,
}
_PEER_SECONDS = 10.9
_NOT_NODES = ("nav2_system_tests", "nav2_rviz_plugins")
_BT = "nav2_behavior_tree/include/nav2_behavior_tree"
_MANAGER = "nav2_lifecycle_manager/include/nav2_lifecycle_manager"
_MANAGER_CLIENT = f"{_MANAGER}/lifecycle_manager_client.hpp"
_COMMANDER = "nav2_simple_commander/nav2_simple_commander"
_NEVER_MADE = {
    ("nav2_collision_monitor/src/pointcloud.cpp", 88): "it is for rclcpp before 30",
    ("nav2_util/include/nav2_util/twist_subscriber.hpp", 125): "tests alone use this constructor",
    (f"{_BT}/utils/test_action_server.hpp", 35): "tests alone use this class",
    (_MANAGER_CLIENT, 66): "rviz's panels and tests alone use this class",
    (_MANAGER_CLIENT, 68): "rviz's panels and tests alone use this class",
    (f"{_COMMANDER}/robot_navigator.py", 1189): "the examples have its call in comments",
}
"""Calls that no program of this commit has, whatever its parameters, by their file and line."""


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
    sites = _made_sites(folder, reporter)
    yield from call_site_figures("nav2", sites, found, reporter, _PEER)
    yield parameter_figure("nav2", parameter_sites(folder), found, reporter)
    yield Figure("nav2.cold", cold, _PEER_SECONDS, "s", at_most=4)
    yield Figure("nav2.warm", warm, None, "s", at_most=1)
    yield from launched


def _made_sites(folder: Path, reporter: Reporter) -> Mapping[str, frozenset[Site]]:
    """Return the calls by kind, without those that no program has."""
    left_out = {(str(folder / file), line): why for (file, line), why in _NEVER_MADE.items()}
    sites = call_sites(folder)
    for kind, found in sites.items():
        for file, line in sorted(found & left_out.keys()):
            why = left_out[file, line]
            reporter.detail([f"  LEFT OUT {kind} {file}:{line}: {why}"])
    return {kind: found - left_out.keys() for kind, found in sites.items()}


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
    """Yield the share of each kind of call that a node declares a name at, beside a peer's."""
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
        unit = f"% of {kind} calls"
        yield Figure(f"{name}.{kind.replace(' ', '_')}", share, theirs, unit, at_least=GOALS[name])


def parameter_figure(
    name: str, sites: frozenset[ParameterSite], programs: Sequence[ProgramScan], reporter: Reporter
) -> Figure:
    """Return the share of the calls that name a parameter which a node has, if only at its end."""
    known = {
        end
        for one in programs
        if one.package not in _NOT_NODES
        for parameter in one.result.interface.parameters
        for end in _endings(parameter.name)
    }
    missed = sorted(site for site in sites if site[2] not in known)
    reporter.lines([f"  {len(sites)} parameter calls, {len(missed)} of them not found"])
    reporter.detail([f"  MISSED parameter {what} {file}:{line}" for file, line, what in missed])
    share = _PERCENT * (1 - len(missed) / max(1, len(sites)))
    return Figure(f"{name}.parameter", share, None, "% of parameter calls", at_least=GOALS[name])


def _endings(name: str) -> Iterator[str]:
    """Yield a name, and what stands behind each of its dots: a prefix is the caller's."""
    yield name
    while "." in name:
        name = name.partition(".")[2]
        yield name


def _named(one: ProgramScan) -> Iterator[Declaration]:
    """Yield what a program's nodes declare of themselves, if something is told of its name."""
    for declared in one.result.interface.declarations:
        if not declared.implicit and declared.node and not _NOTHING.search(declared.name):
            yield declared


def _is_near(site: Site, locations: set[Site]) -> bool:
    file, line = site
    return any((file, line + away) in locations for away in range(-NEAR, NEAR + 1))
