"""ROS 2's launch files: what launch_interface expects of its own, and every one of two large apps.

launch_interface (nineyards-robotics) runs launch files dry with the real launch library. Its
expected results say what each starts; they are compared here with what is read without running.
"""

import json
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from evaluation.common.datasets import Datasets, Reporter
from figures.figure import Figure
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.launch.common.launch_file import find_ros2_launch_files
from rtron.sources.launch.ros2.app import read_app_launch
from rtron.sources.launch.ros2.result import AppLaunch, IncludedFile, LaunchStart, StartKind
from rtron.sources.static.common.worker_pool import deep_recursion
from rtron.sources.workspace import read_workspace

INTERFACE = "nineyards-robotics/launch_interface@e488c3d"
LARGE = ("ros-navigation/navigation2@a3a97043", "autowarefoundation/autoware.universe@b8ce82e3")
ENVIRON = {"HOME": "/home/user", "TEST_NODE_NAME": "env_resolved_node"}
_INSTALLED = "<INSTALL>/test_nodes/share/test_nodes"
_KINDS = {StartKind.CONTAINER: "composable_node_container", StartKind.COMPONENT: "composable_node"}
_SHOWN = 12


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Compare with the expected results, then read all launch files of the large apps."""
    [folder] = datasets.repositories([INTERFACE])
    expected = sorted((folder / "tests" / "expected").glob("*.json"))
    differing = [path.name for path in expected if not _is_equal(path, folder / "tests")]
    reporter.detail([f"  DIFFERS {name}" for name in differing])
    equal = len(expected) - len(differing)
    yield Figure("launch2.expected", len(expected), None, "expected results")
    yield Figure("launch2.equal", equal, None, "equal to the expected", at_least=24)
    for repository in datasets.repositories(LARGE):
        reporter.progress(f"launch files of {repository.name}")
        yield from _all_read(repository, reporter)


def _is_equal(path: Path, tests: Path) -> bool:
    """Tell whether what an expected result says is what is read; commands are not compared."""
    workspace = tests / "test_ws"
    package = workspace / "src" / "test_nodes"
    text = path.read_text().replace(_INSTALLED, str(package))
    expected = json.loads(text.replace("<TEST_WS>", str(workspace)))
    if path.name.startswith("args_"):
        name = path.stem.removeprefix("args_")
        found = _read(package / "launch" / f"{name}.launch.py", {}, package)
        return bool(_arguments(found) == expected)
    arguments = expected["launch_arguments"]
    found = _read(Path(expected["launch_file"]), arguments, package)
    return bool(_as_expected(found, arguments) == _without_commands(expected))


def _read(path: Path, arguments: Mapping[str, str], package: Path) -> AppLaunch:
    files = WorkspaceSources(read_workspace([package], {}))
    return read_app_launch(path, arguments, ENVIRON, files)


def _without_commands(value: Any) -> Any:  # noqa: ANN401 - JSON
    if isinstance(value, dict):
        return {key: _without_commands(one) for key, one in value.items() if key != "cmd"}
    return [_without_commands(one) for one in value] if isinstance(value, list) else value


def _arguments(found: AppLaunch) -> list[dict[str, str | None]]:
    return [
        {"name": one.name, "default": one.default, "description": one.description}
        for one in found.arguments
    ]


def _as_expected(found: AppLaunch, arguments: Mapping[str, str]) -> dict[str, Any]:
    nodes = [one for one in found.starts if one.kind not in {StartKind.PROCESS, *_LOADED}]
    return {
        "launch_file": found.file,
        "launch_arguments": dict(arguments),
        "declared_arguments": {
            one.name: {"default": one.default, "description": one.description}
            for one in found.arguments
        },
        "nodes": [_node(one, found) for one in nodes],
        "includes": [_include(one) for one in found.includes],
    }


def _node(start: LaunchStart, found: AppLaunch) -> dict[str, Any]:
    node = {
        **_common(start, found),
        "executable": start.program,
        "parameter_sources": [
            {"type": "file", "path": source.file}
            for source in start.parameter_sources
            if source.file
        ],
    }
    if start.kind is StartKind.CONTAINER:
        loaded = [one for one in found.starts if one.container == start.full_name]
        node["composable_nodes"] = [_component(one, found) for one in loaded]
    return node


def _component(start: LaunchStart, found: AppLaunch) -> dict[str, Any]:
    extra = {name: one.value for name, one in start.extra_arguments.items()}
    return {**_common(start, found), "plugin": start.program, "extra_arguments": extra}


def _common(start: LaunchStart, found: AppLaunch) -> dict[str, Any]:
    return {
        "type": _KINDS.get(start.kind, "node"),
        "package": start.package,
        "name": start.name or None,
        "namespace": start.namespace,
        "fully_qualified_name": start.full_name if start.name else None,
        "remappings": [list(rule) for rule in start.remaps],
        "parameters": {name: one.value for name, one in start.parameters().items()},
        "source_file": start.evidence.file or found.file,
    }


def _include(included: IncludedFile) -> dict[str, Any]:
    return {
        "source_file": included.evidence.file,
        "included_file": included.file,
        "launch_arguments": dict(included.arguments),
        "includes": [_include(one) for one in included.includes],
    }


_LOADED = frozenset({StartKind.COMPONENT})


@dataclass(slots=True)
class _LaunchOutcome:
    """What became of the launch files of a repository."""

    read: int = 0
    starts: int = 0
    complete: int = 0
    failed: list[str] = field(default_factory=list)
    reasons: Counter[str] = field(default_factory=Counter)


def _all_read(repository: Path, reporter: Reporter) -> Iterator[Figure]:
    before, outcome = time.perf_counter(), _LaunchOutcome()
    files = WorkspaceSources(read_workspace([repository], {}))
    with deep_recursion():
        for path in find_ros2_launch_files([repository]):
            _count(path, files, outcome)
    seconds = time.perf_counter() - before
    reporter.detail([f"  FAILED {location}" for location in outcome.failed])
    reporter.detail([f"  {count:5} {why}" for why, count in outcome.reasons.most_common(_SHOWN)])
    name, total = repository.name.partition("@")[0], outcome.read + len(outcome.failed)
    share = outcome.read / max(1, total)
    yield Figure(f"launch2.{name}.files", total, None, "launch files")
    yield Figure(f"launch2.{name}.read", share, None, "share without failure", at_least=0.95)
    yield Figure(
        f"launch2.{name}.whole", outcome.complete / max(1, total), None, "share without note"
    )
    yield Figure(f"launch2.{name}.starts", outcome.starts, None, "nodes, components, processes")
    yield Figure(f"launch2.{name}.seconds", seconds, None, "s for all")


def _count(path: Path, files: WorkspaceSources, outcome: _LaunchOutcome) -> None:
    try:
        found = read_app_launch(path, {}, ENVIRON, files)
    except Exception as error:  # noqa: BLE001 - what is counted here
        outcome.failed.append(f"{path}: {type(error).__name__}: {error}")
        return
    outcome.read += 1
    outcome.starts += len(found.starts)
    outcome.complete += not found.unresolved
    outcome.reasons.update(note.why[:100] for note in found.unresolved)
