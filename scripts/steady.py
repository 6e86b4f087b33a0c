"""Run test files several times while the cores stall at random, and count what fails.

A real-time process on each core holds it for up to 3 s, now and then all cores at once. No test is
retried. The seed and a run's number decide its stalls. The output and reports of pytest are in
build/steady. Exits 1 if a test fails, 2 if the machine does not allow the stalls.
"""

import argparse
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple, NoReturn

from core_stalls import real_time_share, refusal, schedule, stalling
from junit_report import read_report

ROOT = Path(__file__).parent.parent
ROS2_PYTHON = ROOT / ".venv-ros2" / "bin" / "python"
LIMIT_S, GRACE_S = 1800.0, 30.0
_NO_TESTS = 5


class Run(NamedTuple):
    """One run of a test file: how long it took (s), its stalls, and each failure's reason."""

    file: str
    seconds: float
    stalls: int
    failures: list[str]


def selections(file: str, *, long: bool) -> list[tuple[Path, str]]:
    """Return each Python that runs tests of a file, and which of the tests."""
    short = "" if long else " and not long"
    has_ros2 = "mark.ros2" in Path(file).read_text("utf-8")
    ros2 = [(ROS2_PYTHON, f"ros2{short}")] if has_ros2 else []
    return [(Path(sys.executable), f"not ros2{short}"), *ros2]


def run_file(file: str, seed: str, reports: Path, *, long: bool) -> Run:
    """Run a file's tests once, those on ROS 2 last."""
    stalls = schedule(seed, sorted(os.sched_getaffinity(0)), LIMIT_S)
    seconds, seen, ran, failures = 0.0, 0, 0, list[str]()
    for python, markers in selections(file, long=long):
        report = reports / f"{file} {seed} {markers}.xml".strip("/").replace("/", "-").replace(
            " ", "-"
        )
        start = time.monotonic()
        with stalling(stalls):
            code = _run_pytest([str(python), "-m", "pytest", "-m", markers, file], report)
        took = time.monotonic() - start
        count, failed = outcome(report, code)
        seconds, seen = seconds + took, seen + sum(stall.start < took for stall in stalls)
        ran, failures = ran + count, failures + failed
    return Run(file, seconds, seen, failures if ran or failures else ["no test ran"])


def _run_pytest(command: list[str], report: Path) -> int | None:
    """Return pytest's exit code, or None if it does not end in time."""
    command = [*command, f"--junitxml={report}", "-p", "no:cacheprovider"]
    settings = os.environ | {"CI": "true"}
    report.unlink(missing_ok=True)
    with report.with_suffix(".log").open("wb") as log:
        process = subprocess.Popen(  # noqa: S603 - tests that the user names
            command, env=settings, stdout=log, stderr=log, start_new_session=True
        )
    try:
        return process.wait(LIMIT_S)
    except subprocess.TimeoutExpired:
        return None
    finally:
        if process.poll() is None:
            _stop(process)


def _stop(process: subprocess.Popen[bytes]) -> None:
    """Let pytest tear down its fixtures, then end what is left."""
    process.send_signal(signal.SIGINT)
    with suppress(subprocess.TimeoutExpired):
        process.wait(GRACE_S)
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def outcome(report: Path, code: int | None) -> tuple[int, list[str]]:
    """Return how many tests ran, and each failure with its reason."""
    cases = list(read_report(report)) if report.exists() else []
    failures = [f"{case.name}: {case.reason}" for case in cases if case.outcome == "failed"]
    if code is None or (code not in (0, _NO_TESTS) and not failures):
        ended = f"did not end in {LIMIT_S:.0f} s" if code is None else f"exit code {code}"
        failures.append(f"pytest: {ended}, see {report.with_suffix('.log')}")
    return sum(case.outcome != "skipped" for case in cases), failures


def table(runs: list[Run]) -> str:
    """Return a line for each file, and below it a line for each failure with its run."""
    lines = ["runs  passed  failed  stalls   slowest  file"]
    for file in dict.fromkeys(run.file for run in runs):
        own = [run for run in runs if run.file == file]
        failed, stalls = sum(bool(run.failures) for run in own), sum(run.stalls for run in own)
        counts = f"{len(own):4}  {len(own) - failed:6}  {failed:6}  {stalls:6}"
        lines.append(f"{counts}  {max(run.seconds for run in own):6.1f} s  {file}")
        for number, run in enumerate(own, 1):
            lines += [f"      run {number}: {failure}" for failure in run.failures]
    return "\n".join(lines)


def _exit_on_signal(number: int, _frame: object) -> NoReturn:
    sys.exit(128 + number)


def _arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", help="test files")
    parser.add_argument("--times", type=int, default=10, help="runs of each file (10)")
    parser.add_argument("--seed", type=int, default=time.time_ns() % 10**6, help="of the stalls")
    parser.add_argument("--long", action="store_true", help="run the long tests, too")
    parser.add_argument("--reports", type=Path, default=ROOT / "build" / "steady")
    options = parser.parse_args(words)
    if absent := [file for file in options.files if not Path(file).is_file()]:
        parser.error(f"no test file: {', '.join(absent)}")
    if options.times < 1:
        parser.error("--times must be at least 1")
    return options


def main(words: Sequence[str] | None = None) -> int:
    """Run every file, print the table, and return the exit code."""
    options, share = _arguments(words), real_time_share()
    pythons = {each for file in options.files for each, _ in selections(file, long=options.long)}
    absent = [f"there is no {python}" for python in pythons if not python.exists()]
    if reason := refusal(share) or next(iter(absent), None):
        print(f"steady: cannot run: {reason}", file=sys.stderr)
        return 2
    for stop in (signal.SIGINT, signal.SIGTERM):
        signal.signal(stop, _exit_on_signal)
    print(
        f"steady: --seed {options.seed}; in a stall, other processes get {1 - share:.0%} of a core"
    )
    options.reports.mkdir(parents=True, exist_ok=True)
    runs = list[Run]()
    for file in dict.fromkeys(options.files):
        for number in range(1, options.times + 1):
            seed = f"{options.seed}.{number}"
            runs.append(run_file(file, seed, options.reports, long=options.long))
            ended = "failed" if runs[-1].failures else "passed"
            print(f"{file}: run {number} of {options.times} {ended}", flush=True)
    print(table(runs))
    return int(any(run.failures for run in runs))


if __name__ == "__main__":
    sys.exit(main())
