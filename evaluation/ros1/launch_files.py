"""Every ROS 1 launch file of every app, read with guessed arguments: nothing may fail inside."""

import re
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from evaluation.common.datasets import Datasets, Reporter
from figures.figure import Figure
from rtron.errors import InputError
from rtron.sources.launch.common.launch_file import LaunchFileInfo
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros1.file_search import find_launch_files
from rtron.sources.launch.ros1.reader import read_launch
from rtron.sources.xacro import RobotDescriptions

GUESS = "1"
"""The value of every argument without default, and of every variable that a launch file needs."""
NAME_GUESS = "guess"
"""The value of every argument of a launch file that refuses GUESS: it wants names."""
_NEEDED = re.compile(r"\$\(env (\w+)\)")
_QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"|\S*/\S*|\b\d+\b")
_SHOWN = 100


@dataclass(slots=True)
class LaunchOutcome:
    """What became of the launch files of all repositories; faults are places and reasons."""

    read: int = 0
    seconds: float = 0.0
    refused: list[tuple[str, str]] = field(default_factory=list)
    failed: list[tuple[str, str]] = field(default_factory=list)

    @property
    def files(self) -> int:
        """Return how many launch files there were."""
        return self.read + len(self.refused) + len(self.failed)


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Read all launch files, each with the packages of its own repository."""
    outcome = LaunchOutcome()
    for repository in datasets.all_repositories():
        reporter.progress(f"launch files of {repository.name}")
        _read_all(repository, outcome)
    reporter.lines([*_summary(outcome), ""])
    reporter.detail([f"  FAILED {location}: {why}" for location, why in outcome.failed])
    reporter.detail([f"  REFUSED {location}: {why}" for location, why in outcome.refused])
    share = 1 - len(outcome.failed) / max(1, outcome.files)
    yield Figure("launches.files", outcome.files, None, "launch files")
    yield Figure("launches.interpreted", share, None, "share without internal error", at_least=0.99)
    yield Figure("launches.refused", len(outcome.refused), None, "launch files")
    yield Figure("launches.seconds", outcome.seconds, None, "s for all")


def _read_all(repository: Path, outcome: LaunchOutcome) -> None:
    listed = find_launch_files([repository])
    environ = guessed_environ(listed)
    packages = find_packages([repository], environ)
    describe = RobotDescriptions(packages=packages, environ=environ).describe

    def read(launch: LaunchFileInfo, guess: str) -> None:
        args = dict.fromkeys(launch.required, guess)
        read_launch(launch.path, args, packages, environ, describe=describe)

    for launch in listed:
        before = time.perf_counter()
        _count(str(launch.path.relative_to(repository.parents[1])), partial(read, launch), outcome)
        outcome.seconds += time.perf_counter() - before


def _count(location: str, read: Callable[[str], None], outcome: LaunchOutcome) -> None:
    """Read a launch file; what refuses the first guess is given the second."""
    try:
        refused = _refusal(read, GUESS) and _refusal(read, NAME_GUESS)
    except Exception as error:  # noqa: BLE001 - what is counted here
        outcome.failed.append((location, f"{type(error).__name__}: {error}"))
        return
    if refused:
        outcome.refused.append((location, refused))
    else:
        outcome.read += 1


def _refusal(read: Callable[[str], None], guess: str) -> str:
    try:
        read(guess)
    except InputError as error:
        return str(error)
    return ""


def guessed_environ(listed: Iterable[LaunchFileInfo]) -> Mapping[str, str]:
    """Return a value for each variable that launch files cannot be read without."""
    texts = (launch.path.read_bytes().decode("utf-8", "replace") for launch in listed)
    return {name: GUESS for text in texts for name in _NEEDED.findall(text)}


def _summary(outcome: LaunchOutcome) -> Iterator[str]:
    yield f"{outcome.files} launch files: {outcome.read} read, {len(outcome.refused)} refused"
    yield f"  with an internal error: {len(outcome.failed)}"
    causes = Counter(_cause(why) for _, why in outcome.refused)
    yield from (f"  refused {count}: {cause[:_SHOWN]}" for cause, count in causes.most_common())


def _cause(why: str) -> str:
    """Return a reason without its names, so that equal causes count together."""
    return " ".join(_QUOTED.sub("…", why.removeprefix("/")).split())
