"""autoware.universe: all its programs, without a launch: the time, the memory, what is found.

A call counts as found like one of navigation2's. Most libraries that its nodes are made of lie in
other repositories (autoware_core, autoware_utils): what only these decide cannot be found here.
"""

import resource
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from evaluation.common.datasets import Datasets, Reporter
from evaluation.ros2.call_sites import call_sites, parameter_sites
from evaluation.ros2.navigation2 import call_site_figures, parameter_figure
from evaluation.ros2.program_scan import scan_programs
from figures.figure import Figure
from rtron.sources.static.common.scan_options import ScanOptions, default_workers
from rtron.sources.static.ros2.app import read_ros2_workspace

_REPOSITORY = "autowarefoundation/autoware.universe@b8ce82e3"
_KIB_PER_MIB = 1024


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Scan all programs with an empty cache, and look for each call."""
    [folder] = datasets.repositories([_REPOSITORY])
    reporter.progress("autoware.universe, cold")
    with tempfile.TemporaryDirectory(prefix="rtron-eval-") as name:
        options = ScanOptions(cache=Path(name) / "cache")
        before = time.perf_counter()
        found = list(scan_programs(read_ros2_workspace([folder]), folder, options))
        seconds = time.perf_counter() - before
    yield from call_site_figures("universe", call_sites(folder), found, reporter)
    yield parameter_figure("universe", parameter_sites(folder), found, reporter)
    failed = sum(_failed(note.why) for one in found for note in one.result.interface.unresolved)
    yield Figure("universe.programs", len(found), None, "programs")
    yield Figure("universe.failed", failed, None, "programs", at_most=0)
    yield Figure("universe.cold", seconds, None, "s", at_most=90)
    yield Figure("universe.memory", _memory(), None, "MiB", at_most=2048)


def _failed(why: str) -> bool:
    return why.startswith(("RTron failed", "not done within", "too large", "nested too deep"))


def _memory() -> float:
    """Return the most that this process and those it started can have held at one time, MiB."""
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    largest = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    return (own + default_workers() * largest) / _KIB_PER_MIB
