"""`make steady` stalls the cores as its seed says, and counts every failed run of a file."""

import itertools
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from statistics import mean

import pytest
import steady
from core_stalls import EVERY_S, LONGEST_S, MEAN_S, SHORTEST_S, real_time_share, refusal, schedule
from steady import ROS2_PYTHON, Run, outcome, selections, table

TOOL = Path(steady.__file__)
WAIT_S = 60.0
REFUSAL = refusal(real_time_share())
needs_real_time = pytest.mark.skipif(REFUSAL is not None, reason=str(REFUSAL))

MIXED = """
import pytest

def test_b():
    pass

def test_a():
    assert 1 + 1 == 3, "bad sum"

def test_ci():
    import os
    assert os.environ["CI"] == "true"

@pytest.mark.parametrize("each", [1])
def test_setup(each, absent):
    pass

@pytest.mark.skip
def test_skipped():
    raise AssertionError
"""

SPINNERS = """
import os
import time
from pathlib import Path

def children():
    parent = os.getppid()
    listed = Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
    return [pid for each in listed if (pid := int(each)) != os.getpid()]

def ticks(pid):
    return int(Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[11])

def wait_for(condition):
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)
"""
HELD = f"""{SPINNERS}
def test_spinners():
    pids = children()
    assert {{os.sched_getscheduler(pid) for pid in pids}} == {{os.SCHED_FIFO}}
    cores = [os.sched_getaffinity(pid) for pid in pids]
    assert cores == [{{core}} for core in sorted(os.sched_getaffinity(0))]
    wait_for(lambda: any(ticks(pid) > 5 for pid in pids))
"""
WAITING = f"""{SPINNERS}
def test_wait():
    listing = Path(__file__).with_suffix(".pids")
    listing.with_suffix(".new").write_text(" ".join(map(str, [os.getpid(), *children()])))
    listing.with_suffix(".new").rename(listing)
    wait_for(lambda: False)
"""


def seed_where(fits):
    """Return a seed whose first run has stalls that fit."""
    cores = sorted(os.sched_getaffinity(0))
    return next(seed for seed in itertools.count() if fits(schedule(f"{seed}.1", cores, 600.0)))


def is_calm(stalls):
    """Tell whether the other tests of this machine are left alone for two minutes."""
    return stalls[0].start > 60.0


def is_short_and_early(stalls):
    return stalls[0].start < 0.5 and stalls[0].end - stalls[0].start < 0.15 and stalls[1].start > 30


def tool_command(folder, text, fits=is_calm):
    file = folder / "test_tiny.py"
    file.write_text(text)
    options = ["--times", "1", "--seed", str(seed_where(fits)), "--reports", str(folder)]
    return [sys.executable, str(TOOL), str(file), *options]


def wait_until(condition):
    end = time.monotonic() + WAIT_S
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def is_running(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


@pytest.fixture(autouse=True)
def no_plugins(monkeypatch):
    """Let pytest load no plugins: they take a second."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")


@pytest.fixture(scope="module")
def long_schedule():
    return schedule("1", [0, 1], 100_000.0)


def test_each_stall_ends_in_its_bounds_and_before_the_next(long_schedule):
    lengths = [stall.end - stall.start for stall in long_schedule]
    assert SHORTEST_S - 1e-9 <= min(lengths) < SHORTEST_S + 0.01
    assert LONGEST_S - 0.1 < max(lengths) <= LONGEST_S + 1e-9
    assert mean(lengths) == pytest.approx(MEAN_S, rel=0.02)
    assert all(before.end < after.start for before, after in itertools.pairwise(long_schedule))
    assert long_schedule[0].start > 0.0
    assert 99_000.0 < long_schedule[-1].start < 100_000.0


@pytest.mark.parametrize("cores", [[0], [0, 1], [1, 3, 5, 7]])
def test_each_core_stalls_alone_and_with_the_others_every_12_s(cores):
    stalls = schedule("1", cores, 100_000.0)
    assert {tuple(stall.cores) for stall in stalls} == {tuple(cores), *((core,) for core in cores)}
    for core in cores:
        starts = [stall.start for stall in stalls if core in stall.cores]
        gaps = [after - before for before, after in itertools.pairwise(starts)]
        assert mean(gaps) == pytest.approx(EVERY_S, rel=0.03)


def test_the_same_seed_gives_the_same_stalls(long_schedule):
    assert schedule("1", [0, 1], 100_000.0) == long_schedule
    assert schedule("1", [0, 1], 50_000.0) == [s for s in long_schedule if s.start < 50_000.0]
    assert schedule("2", [0, 1], 100_000.0) != long_schedule


def test_a_file_runs_on_each_ros_that_its_markers_name(tmp_path):
    file = tmp_path / "test_x.py"
    file.write_text("def test_x(): pass")
    other = Path(sys.executable)
    assert selections(str(file), long=True) == [(other, "not ros2")]
    file.write_text("@pytest.mark.ros2\ndef test_x(): pass")
    assert selections(str(file), long=False) == [
        (other, "not ros2 and not long"),
        (ROS2_PYTHON, "ros2 and not long"),
    ]


def test_pytest_without_a_report_has_failed(tmp_path):
    report = tmp_path / "run.xml"
    assert outcome(report, 5) == (0, [])
    assert outcome(report, 3) == (0, [f"pytest: exit code 3, see {tmp_path}/run.log"])
    assert outcome(report, None) == (0, [f"pytest: did not end in 1800 s, see {tmp_path}/run.log"])


def test_the_table_has_a_line_for_each_file_and_each_failure():
    runs = [
        Run("tests/b.py", 1.0, 2, []),
        Run("tests/b.py", 12.34, 3, ["test_x: late", "test_y: lost"]),
        Run("tests/a.py", 100.0, 0, []),
    ]
    assert table(runs).splitlines() == [
        "runs  passed  failed  stalls   slowest  file",
        "   2       1       1       5    12.3 s  tests/b.py",
        "      run 2: test_x: late",
        "      run 2: test_y: lost",
        "   1       1       0       0   100.0 s  tests/a.py",
    ]


@needs_real_time
def test_a_run_names_each_failure_in_order(tmp_path):
    done = subprocess.run(
        tool_command(tmp_path, MIXED), capture_output=True, text=True, timeout=240, check=False
    )
    first, ended, _, counts, *failures = done.stdout.splitlines()
    file = f"{tmp_path}/test_tiny.py"
    assert re.match(r"steady: --seed \d+; in a stall, other processes get \d+% of a core$", first)
    assert ended == f"{file}: run 1 of 1 failed"
    assert re.match(rf"   1       0       1       0 +\d+\.\d s  {re.escape(file)}$", counts)
    assert failures == [
        "      run 1: test_a: AssertionError: bad sum",
        f'      run 1: test_setup[1]: failed on setup with "file {file}, line 14',
    ]
    assert (done.returncode, done.stderr) == (1, "")


@needs_real_time
def test_a_real_time_process_holds_each_core(tmp_path):
    done = subprocess.run(
        tool_command(tmp_path, HELD, is_short_and_early),
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert re.match("   1       1       0       1 ", done.stdout.splitlines()[-1]), done.stdout
    assert done.returncode == 0


@needs_real_time
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_no_spinner_outlives_the_tool(number, tmp_path):
    listing = tmp_path / "test_tiny.pids"
    with subprocess.Popen(tool_command(tmp_path, WAITING), stdout=subprocess.DEVNULL) as tool:
        wait_until(listing.exists)
        tests, *spinners = map(int, listing.read_text().split())
        assert len(spinners) == len(os.sched_getaffinity(0))
        assert all(map(is_running, [tests, *spinners]))
        tool.send_signal(number)
        ended = tool.wait(WAIT_S)
    wait_until(lambda: not any(map(is_running, spinners)))
    if number == signal.SIGKILL:
        assert ended == -number
        os.kill(tests, signal.SIGKILL)
    else:
        assert ended == 128 + number
        assert not is_running(tests)
