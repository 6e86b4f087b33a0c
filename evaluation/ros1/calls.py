"""Autoware.AI 1.10.0: how much of what its programs declare can be resolved, and in what time."""

import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from evaluation.call_count import CallCount, count_calls, is_explained
from evaluation.common.datasets import Place
from evaluation.part import Tell
from evaluation.ros1.call_sites import call_sites, unreached
from evaluation.ros1.launch_files import GUESS, guessed_environ
from evaluation.ros1.rosdiscover import AUTOWARE_CALLS_UNKNOWN, AUTOWARE_NODES_TOUCHED
from figures.figure import Figure
from rtron.errors import InputError
from rtron.sources.launch.ros1.file_search import launch_files
from rtron.sources.launch.ros1.reader import read_launch
from rtron.sources.static.common.cache import open_cache
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import Task, TaskResult
from rtron.sources.static.common.worker_pool import Pool
from rtron.sources.static.common.workspace_hash import workspace_state
from rtron.sources.static.programs import programs
from rtron.sources.static.ros1.app import scan_app
from rtron.sources.workspace import Workspace, read_workspace

_REPOSITORY = "CPFL/Autoware@5c46036"
_PERCENT = 100


@dataclass(frozen=True, slots=True)
class Interpreted:
    """Each program with its result, how many launch files were scanned, and in what time, s."""

    results: Sequence[tuple[Task, TaskResult]]
    launches: int
    seconds: float


def figures(here: Place, tell: Tell) -> Iterator[Figure]:
    """Interpret all programs and scan all launch files, with an empty cache and with a full one."""
    (folder,) = here.repositories([_REPOSITORY])
    with tempfile.TemporaryDirectory(prefix="rtron-eval-") as name:
        options = ScanOptions(cache=Path(name) / "cache")
        tell.progress("Autoware.AI 1.10.0, cold")
        cold = _interpreted(folder, options)
        tell.progress("Autoware.AI 1.10.0, warm")
        warm = _interpreted(folder, options)
    counted = [(task, result, count_calls(result.interface)) for task, result in cold.results]
    yield from _counted([(task, count) for task, _, count in counted], tell)
    yield _reached(counted, tell)
    tell.lines([f"  {cold.launches} launch files scanned as one app", ""])
    tell.detail([line for task, result, _ in counted for line in _faults(task, result)])
    yield Figure("calls.cold", cold.seconds, None, "s", at_most=60)
    yield Figure("calls.warm", warm.seconds, None, "s", at_most=5)


def _reached(counted: Sequence[tuple[Task, TaskResult, CallCount]], tell: Tell) -> Figure:
    """Tell which places look like calls and were not come to."""
    sites = call_sites({path for task, _, _ in counted for path in task.sources})
    missed = unreached(sites, [call for _, _, count in counted for call in count.calls])
    tell.lines([f"  {len(sites)} places look like calls, {len(missed)} of them not reached"])
    tell.detail([f"  UNREACHED {file}:{line}" for file, line in missed])
    share = 1 - len(missed) / max(1, len(sites))
    return Figure("calls.reached", share * _PERCENT, None, "% of places that look like calls")


def _counted(counts: Sequence[tuple[Task, CallCount]], tell: Tell) -> Iterator[Figure]:
    nodes = [count for _, count in counts if count.calls]
    touched = sum(bool(count.unresolved) for count in nodes)
    calls = sum(len(count.calls) for count in nodes)
    unresolved = sum(len(count.unresolved) for count in nodes)
    kinds = Counter(task.kind.value for task, count in counts if count.calls)
    shown = ", ".join(f"{number} {kind}" for kind, number in sorted(kinds.items()))
    tell.lines(
        [
            f"Autoware.AI 1.10.0: {len(counts)} programs, {len(nodes)} with calls ({shown})",
            f"  {calls} calls, {unresolved} with an unresolved name, in {touched} nodes",
        ]
    )
    share, nodes_share = unresolved / max(1, calls), touched / max(1, len(nodes))
    peers = (AUTOWARE_CALLS_UNKNOWN, AUTOWARE_NODES_TOUCHED)
    yield Figure("calls.unresolved", share * _PERCENT, peers[0], "% of calls", at_most=6)
    yield Figure("calls.touched", nodes_share * _PERCENT, peers[1], "% of nodes", at_most=15)


def _interpreted(folder: Path, options: ScanOptions) -> Interpreted:
    before = time.perf_counter()
    workspace = read_workspace([folder], {})
    results = list(_results(workspace, folder, options))
    launches = _scan_launches(workspace, folder, options)
    return Interpreted(results, launches, time.perf_counter() - before)


def _results(
    workspace: Workspace, folder: Path, options: ScanOptions
) -> Iterator[tuple[Task, TaskResult]]:
    cache = open_cache(options.cache, workspace_state(workspace))
    missing: list[Task] = []
    for _, task in programs(workspace, folder):
        known = cache.get(task)
        if known is None:
            missing.append(task)
        else:
            yield task, known
    pool = Pool(workspace, options.workers, options.seconds)
    try:
        for task, result in pool.run(missing):
            cache.put(task, result)
            yield task, result
    finally:
        pool.close()


def _scan_launches(workspace: Workspace, folder: Path, options: ScanOptions) -> int:
    """Scan all launch files that can be read as one app; return how many they are."""
    environ = guessed_environ(listed := launch_files([folder]))
    guessed = [(launch.path, dict.fromkeys(launch.required, GUESS)) for launch in listed]
    readable = [(p, args) for p, args in guessed if _is_readable(p, args, workspace, environ)]
    scan_app([folder], readable, environ, options)
    return len(readable)


def _is_readable(
    path: Path, args: Mapping[str, str], workspace: Workspace, environ: Mapping[str, str]
) -> bool:
    try:
        read_launch(path, args, workspace.packages, environ)
    except InputError:
        return False
    return True


def _faults(task: Task, result: TaskResult) -> Iterator[str]:
    for found in result.interface.declarations:
        if not found.implicit and not is_explained(found.name):
            place = found.evidence[0]
            yield f"  UNRESOLVED {found.kind.value} {found.name} {place.file}:{place.line}"
    for note in result.interface.unresolved:
        yield f"  {task.site.name}: {note.what}: {note.why} {note.evidence[:1]}"
