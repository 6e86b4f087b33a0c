"""Run lint and the tests in groups, the fast ones first, and say at the end what ran and failed.

    scripts/run_tests.py [GROUP…] [--long] [--changed] [--durations]

Each group of tests is a process of pytest. Its results stay in `build/tests` as JUnit XML.
If one of the first three fails, the groups behind it do not run.
"""

import argparse
import shutil
import subprocess
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from junit_report import read_report

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "build" / "tests"
PYTHON, ROS2_PYTHON = ".venv/bin/python", ".venv-ros2/bin/python"
COVERED = (
    "tests/policies/",
    "tests/risks/",
    "tests/coherence/",
    "tests/vocabulary/",
    "tests/planning/plan_file/test_read_",
)
"""How the paths of tests begin that run every branch of what they test."""
COVERAGE = (
    *(f"--cov=rtron.{name}" for name in ("policies", "risks", "coherence", "vocabulary")),
    "--cov-branch",
    "--cov-report=term-missing:skip-covered",
    "--cov-fail-under=100",
)
STARTS_PROGRAMS = ("tests/service", "tests/survey", "tests/packaging")
"""Where the tests start servers, browsers and commands, and take longest."""
PROCESSES = 3
ROS_PROCESSES = 4
"""Tests on real ROS processes wait more: three leave a fifth of two cores idle."""
LONGEST_GROUP = 3600
"""After so many seconds a group is killed: pytest's own limit of a test did not end it."""
NO_TESTS = 5
"""Pytest's exit code where nothing was selected."""
SLOWEST = 30
LONGEST_FIRST = ROOT / "tests" / "longest_first.txt"
"""The files that a run begins with, so that none of them is alone at its end."""
LONG_FILE = 20
"""Seconds; a file that takes more stands there."""
LONG_TEST = 20
"""Seconds; a test that takes more says why in its docstring."""
OUTCOMES = ("passed", "failed", "skipped")


@dataclass(frozen=True)
class Group:
    """A part of the check: its command, and whether it must pass before the next groups run."""

    name: str
    command: tuple[str, ...]
    is_gate: bool = True


@dataclass
class Result:
    """What became of a group: its exit code, its time in seconds, its tests by outcome."""

    name: str
    code: int
    seconds: float
    counts: dict[str, int] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)


def files_with(marker: str) -> list[str]:
    """Return the files of tests in which a marker stands, or all, sorted."""
    paths = sorted((ROOT / "tests").rglob("test_*.py"))
    text = f"mark.{marker}" if marker else ""
    return [str(path.relative_to(ROOT)) for path in paths if text in path.read_text()]


def all_groups(*, is_long: bool) -> list[Group]:
    """Return the groups in their order: those first that find most faults in a minute."""
    ros1, network = files_with("ros1"), files_with("network")
    covered = [path for path in files_with("") if path.startswith(COVERED)]
    partly = {*files_with("timed"), *files_with("ros2")}
    wholly = [path for path in covered if path not in partly]
    pure = ("tests", *_without(*ros1, *network, *STARTS_PROGRAMS, *wholly))
    # what waits for the network begins first: the others run meanwhile
    service = (*network, *STARTS_PROGRAMS, *_without(*ros1))
    rest = "not ros2 and not covered"
    ros = {"is_gate": False, "processes": ROS_PROCESSES}
    return [
        Group("lint", ("make", "--no-print-directory", "lint")),
        _tests("covered", "covered", (*covered, *COVERAGE), is_long=is_long),
        _tests("pure", rest, pure, is_long=is_long),
        _tests("service", rest, service, is_long=is_long, is_gate=False),
        _tests("ros2", "ros2", files_with("ros2"), is_long=is_long, python=ROS2_PYTHON, **ros),
        _tests("ros1", rest, ros1, is_long=is_long, **ros),
    ]


def changed_groups(base: str) -> list[Group]:
    """Return lint, and what needs neither ROS nor network of the tests of what was changed."""
    listed = ("git", "diff", "--name-only", "--no-renames", base, "--", "src/rtron", "tests")
    others = ("git", "ls-files", "--others", "--exclude-standard", "src/rtron", "tests")
    names = {name for command in (listed, others) for name in _lines(command)}
    places = sorted({place for name in names if (place := _tests_of(Path(name)))})
    apart = {*files_with("ros1"), *files_with("ros2"), *files_with("network")}
    chosen = [place for place in places if place not in apart]
    left_out = _without(*sorted(apart))
    lint = Group("lint", ("make", "--no-print-directory", "lint"))
    return [lint, _tests("changed", "not ros2", (*chosen, *left_out))] if chosen else [lint]


def _without(*places: str) -> tuple[str, ...]:
    return tuple(f"--ignore={place}" for place in places)


def _tests_of(path: Path) -> str | None:
    """Return what tests a file: itself, or the nearest folder of tests that mirrors its own."""
    if path.name.startswith("test_"):
        return str(path) if (ROOT / path).exists() else None
    folders = Path("tests", *path.parts[2 if path.parts[0] == "src" else 1 : -1])
    while not (ROOT / folders).is_dir():
        folders = folders.parent
    return str(folders) if len(folders.parts) > 1 else None


def _lines(command: tuple[str, ...]) -> list[str]:
    return subprocess.run(  # noqa: S603 - git
        command, cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.split()


def _tests(
    name: str,
    marks: str,
    arguments: Iterable[str],
    *,
    is_long: bool = False,
    python: str = PYTHON,
    is_gate: bool = True,
    processes: int = PROCESSES,
) -> Group:
    how = ("--hypothesis-profile=thorough",) if is_long else ()
    command = (
        *(python, "-m", "pytest", "-q", "-m", marks if is_long else f"({marks}) and not long"),
        *("--processes", str(processes), f"--junitxml={RESULTS / name}.xml"),
    )
    return Group(name, (*command, *how, *arguments), is_gate)


def run_all(groups: list[Group]) -> list[Result]:
    """Run one group after the other; return what became of each that ran.

    Where a Python is not installed, as that of ROS 2 on arm64, its tests do not run.
    """
    RESULTS.mkdir(parents=True, exist_ok=True)
    results: list[Result] = []
    for group in groups:
        if shutil.which(ROOT / group.command[0]) is None and group.command[0] != "make":
            continue
        print(f"== {group.name}", flush=True)
        results.append(run(group))
        if results[-1].code and group.is_gate:
            break
    return results


def run(group: Group) -> Result:
    """Run a group to its end; return its outcome."""
    report = RESULTS / f"{group.name}.xml"
    report.unlink(missing_ok=True)
    started = time.monotonic()
    try:
        code = subprocess.run(  # noqa: S603 - see all_groups
            group.command, cwd=ROOT, check=False, timeout=LONGEST_GROUP
        ).returncode
    except subprocess.TimeoutExpired:
        code = -1
    result = Result(group.name, 0 if code == NO_TESTS else code, time.monotonic() - started)
    if report.exists():
        _count(result, report)
    if result.code and not result.failures:
        why = f"not done within {LONGEST_GROUP} s" if code == -1 else f"exit code {code}, see above"
        result.failures.append(f"{group.name}: {why}")
    return result


def _count(result: Result, report: Path) -> None:
    """Add the tests that pytest has written into a group's report."""
    for case in read_report(report):
        result.counts[case.outcome] = result.counts.get(case.outcome, 0) + 1
        if case.outcome == "failed":
            result.failures.append(f"{case.place}::{case.name}: {case.reason}")


def print_summary(results: list[Result], groups: list[Group]) -> None:
    """Print a line for each group, one for each failure, and the sums last."""
    print("\n== summary")
    for each in results:
        tests = ", ".join(f"{count:,} {outcome}" for outcome, count in sorted(each.counts.items()))
        state = "ok" if each.code == 0 else f"FAILED ({each.code})"
        print(f"{each.name:8} {_clock(each.seconds):>6}  {state:12} {tests}")
    ran = {each.name for each in results}
    for group in groups:
        if group.name not in ran:
            print(f"{group.name:8} {'-':>6}  did not run")
    for each in results:
        for failure in each.failures:
            print(f"FAILED {failure}")
    sums = {key: sum(each.counts.get(key, 0) for each in results) for key in OUTCOMES}
    print(f"\nin {_clock(sum(each.seconds for each in results))}")
    print(", ".join(f"{sums[key]} {key}" for key in OUTCOMES))


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02}"


def print_durations() -> None:
    """Print the slowest files of the last run, and the tests that take long."""
    cases = [case for path in RESULTS.glob("*.xml") for case in read_report(path)]
    files: dict[str, float] = {}
    for case in cases:
        files[case.place] = files.get(case.place, 0) + case.seconds
    slowest = sorted(files.items(), key=lambda item: -item[1])
    for place, seconds in slowest[:SLOWEST]:
        print(f"{seconds:7.1f} s  {place}.py")
    print(f"\nover {LONG_FILE} s, for {LONGEST_FIRST.name}:")
    print("\n".join(f"{place}.py" for place, seconds in slowest if seconds > LONG_FILE))
    print(f"\nover {LONG_TEST} s:")
    for case in sorted(cases, key=lambda case: -case.seconds):
        if case.seconds > LONG_TEST:
            print(f"{case.seconds:7.1f} s  {case.place}::{case.name}")


def main() -> int:
    """Run what the arguments name; return 1 if something failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("group", nargs="*", help="only these groups")
    parser.add_argument(
        "--long", action="store_true", help="the long tests too, with more examples"
    )
    parser.add_argument("--changed", metavar="BASE", help="only what differs from a commit")
    parser.add_argument("--durations", action="store_true", help="show the slowest of the last run")
    options = parser.parse_args()
    if options.durations:
        print_durations()
        return 0
    groups = (
        changed_groups(options.changed) if options.changed else all_groups(is_long=options.long)
    )
    names = [each.name for each in groups]
    if unknown := set(options.group).difference(names):
        parser.error(f"no group {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    chosen = [each for each in groups if each.name in options.group or not options.group]
    results = run_all(chosen)
    print_summary(results, chosen)
    return int(any(each.code for each in results))


if __name__ == "__main__":
    sys.exit(main())
