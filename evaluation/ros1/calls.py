"""Autoware.AI 1.10.0: how much of what its programs declare can be resolved, and in what time."""

import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from evaluation.common.datasets import Datasets, Reporter
from evaluation.ros1.call_sites import CallCount, call_sites, count_calls, is_explained, unreached
from evaluation.ros1.launch_files import GUESS, guessed_environ
from evaluation.ros1.rosdiscover import AUTOWARE_CALLS_UNKNOWN, AUTOWARE_NODES_TOUCHED
from figures.figure import Figure
from rtron.errors import InputError
from rtron.sources.launch.ros1.file_search import find_launch_files
from rtron.sources.launch.ros1.reader import read_launch
from rtron.sources.static.common.cache import hash_workspace, open_cache
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import InterpretationTask, TaskResult
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.static.ros1.app import scan_app
from rtron.sources.static.ros1.message_traffic import workspace_programs
from rtron.sources.workspace import Workspace, read_workspace

_REPOSITORY = "CPFL/Autoware@5c46036"
_PERCENT = 100


@dataclass(frozen=True, slots=True)
class InterpretedApp:
    """Each program with its result, how many launch files were scanned, and in what time, s."""

    results: Sequence[tuple[InterpretationTask, TaskResult]]
    launches: int
    seconds: float


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Interpret all programs and scan all launch files, with an empty cache and with a full one."""
    (folder,) = datasets.repositories([_REPOSITORY])
    with tempfile.TemporaryDirectory(prefix="rtron-eval-") as name:
        options = ScanOptions(cache=Path(name) / "cache")
        reporter.progress("Autoware.AI 1.10.0, cold")
        cold = _interpreted(folder, options)
        reporter.progress("Autoware.AI 1.10.0, warm")
        warm = _interpreted(folder, options)
    counted = [(task, result, count_calls(result.interface)) for task, result in cold.results]
    yield from _counted([(task, count) for task, _, count in counted], reporter)
    yield _reached(counted, reporter)
    reporter.lines([f"  {cold.launches} launch files scanned as one app", ""])
    reporter.detail([line for task, result, _ in counted for line in _problems(task, result)])
    yield Figure("calls.cold", cold.seconds, None, "s", at_most=60)
    yield Figure("calls.warm", warm.seconds, None, "s", at_most=5)


def _reached(
    counted: Sequence[tuple[InterpretationTask, TaskResult, CallCount]], reporter: Reporter
) -> Figure:
    """Tell which places look like calls and were not come to."""
    sites = call_sites({path for task, _, _ in counted for path in task.sources})
    missed = unreached(sites, [call for _, _, count in counted for call in count.calls])
    reporter.lines([f"  {len(sites)} places look like calls, {len(missed)} of them not reached"])
    reporter.detail([f"  UNREACHED {file}:{line}" for file, line in missed])
    share = 1 - len(missed) / max(1, len(sites))
    return Figure("calls.reached", share * _PERCENT, None, "% of places that look like calls")


def _counted(
    counts: Sequence[tuple[InterpretationTask, CallCount]], reporter: Reporter
) -> Iterator[Figure]:
    nodes = [count for _, count in counts if count.calls]
    touched = sum(bool(count.unresolved) for count in nodes)
    calls = sum(len(count.calls) for count in nodes)
    unresolved = sum(len(count.unresolved) for count in nodes)
    kinds = Counter(task.kind.value for task, count in counts if count.calls)
    shown = ", ".join(f"{number} {kind}" for kind, number in sorted(kinds.items()))
    reporter.lines(
        [
            f"Autoware.AI 1.10.0: {len(counts)} programs, {len(nodes)} with calls ({shown})",
            f"  {calls} calls, {unresolved} with an unresolved name, in {touched} nodes",
        ]
    )
    share, nodes_share = unresolved / max(1, calls), touched / max(1, len(nodes))
    peers = (AUTOWARE_CALLS_UNKNOWN, AUTOWARE_NODES_TOUCHED)
    yield Figure("calls.unresolved", share * _PERCENT, peers[0], "% of calls", at_most=6)
    yield Figure("calls.touched", nodes_share * _PERCENT, peers[1], "% of nodes", at_most=15)


def _interpreted(folder: Path, options: ScanOptions) -> InterpretedApp:
    before = time.perf_counter()
    workspace = read_workspace([folder], {})
    results = list(_results(workspace, folder, options))
    launches = _scan_launches(workspace, folder, options)
    return InterpretedApp(results, launches, time.perf_counter() - before)


def _results(
    workspace: Workspace, folder: Path, options: ScanOptions
) -> Iterator[tuple[InterpretationTask, TaskResult]]:
    cache = open_cache(options.cache, hash_workspace(workspace))
    missing: list[InterpretationTask] = []
    for _, task in workspace_programs(workspace, folder):
        known = cache.get(task)
        if known is None:
            missing.append(task)
        else:
            yield task, known
    pool = WorkerPool(workspace, options.workers, options.seconds)
    try:
        for task, result in pool.run_tasks(missing):
            cache.put(task, result)
            yield task, result
    finally:
        pool.close()


def _scan_launches(workspace: Workspace, folder: Path, options: ScanOptions) -> int:
    """Scan all launch files that can be read as one app; return how many they are."""
    environ = guessed_environ(listed := find_launch_files([folder]))
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


def _problems(task: InterpretationTask, result: TaskResult) -> Iterator[str]:
    for found in result.interface.declarations:
        if not found.implicit and not is_explained(found.name):
            location = found.evidence[0]
            yield f"  UNRESOLVED {found.kind.value} {found.name} {location.file}:{location.line}"
    for note in result.interface.unresolved:
        yield f"  {task.site.name}: {note.what}: {note.why} {note.evidence[:1]}"
