"""Processes of ours end with their block: also those that ended their sessions, or ignore us."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from harness import lives, wait_for

from rtron.demos.runtime.processes import ProcessGroup
from rtron.errors import SourceError

IGNORE = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
SLEEP = [sys.executable, "-c", "import time; print('here', flush=True); time.sleep(600)"]
DEAF = """
import signal, time
for number in (signal.SIGINT, signal.SIGTERM): signal.signal(number, signal.SIG_IGN)
print('here', flush=True)
time.sleep(600)
"""
DEAF = [sys.executable, "-c", DEAF]
LEFT_BEHIND = """
import subprocess, sys
sleep = [sys.executable, '-c', 'import time; time.sleep(600)']
print(subprocess.Popen(sleep, start_new_session=True).pid, flush=True)
"""
LEFT_BEHIND = [sys.executable, "-c", LEFT_BEHIND]
RUNNER = """
import sys
from pathlib import Path
from rtron.demos.runtime.processes import ProcessGroup
with ProcessGroup(Path(sys.argv[1])) as processes:
    for command in {commands!r}:
        print(processes.start(command, {{}}).popen.pid, flush=True)
    print('all', flush=True)
    processes.run_command({sleep!r}, {{}})
"""


@pytest.fixture
def processes(tmp_path):
    with ProcessGroup(tmp_path) as processes:
        yield processes


def here(started):
    return wait_for(started.output, what="its first word")


def test_what_runs_ends_with_the_block(tmp_path):
    with ProcessGroup(tmp_path) as processes:
        pids = [processes.start(SLEEP, os.environ).popen.pid for _ in range(3)]
        assert all(map(lives, pids))
    assert not any(map(lives, pids))


def test_the_watchdog_finds_rtron_from_another_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", "src")
    with ProcessGroup(tmp_path) as processes:
        environ = Path(f"/proc/{processes._watchdog.pid}/environ").read_text().split("\0")
    (path,) = (each for each in environ if each.startswith("PYTHONPATH="))
    assert all(map(os.path.isabs, path.partition("=")[2].split(os.pathsep)))


def test_who_does_not_listen_is_killed(tmp_path, monkeypatch):
    steps = [(number, 0.2) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)]
    monkeypatch.setattr("rtron.demos.runtime.processes._TERMINATION_STEPS", steps)
    with ProcessGroup(tmp_path) as processes:
        started = processes.start(DEAF, os.environ)
        here(started)
    assert started.popen.returncode == -signal.SIGKILL


def test_what_a_dead_process_has_left_in_another_session_is_killed(tmp_path):
    with ProcessGroup(tmp_path) as processes:
        started = processes.start(LEFT_BEHIND, os.environ)
        pid = int(here(started))
        started.popen.wait(60)
        assert lives(pid)
    assert not lives(pid)


def test_a_strangers_process_is_left_alone(processes):
    stranger = subprocess.Popen(SLEEP, stdout=subprocess.PIPE)
    try:
        assert stranger.stdout.readline() == b"here\n"
        processes.end([processes.start(SLEEP, os.environ)])
        assert stranger.poll() is None
    finally:
        stranger.kill()
        stranger.communicate()


def test_a_command_is_told_with_what_it_printed(processes):
    done = processes.run_command([sys.executable, "-c", "print('a b')"], os.environ)
    assert (done.code, done.text) == (0, "a b\n")
    assert done.command.endswith("""-c 'print('"'"'a b'"'"')'""")


def test_nothing_is_imported_from_the_users_folder(processes, tmp_path, monkeypatch):
    (tmp_path / "user").mkdir()
    (tmp_path / "user" / "yaml.py").write_text("raise SystemExit('imported')")
    monkeypatch.chdir(tmp_path / "user")
    done = processes.run_command([sys.executable, "-c", "import yaml; print('fine')"], os.environ)
    assert done.text == "fine\n"


def test_a_command_that_fails_says_why(processes):
    fails = [sys.executable, "-c", "import sys; print('no way'); sys.exit(3)"]
    with pytest.raises(SourceError, match=r"failed \(3\)\n01-python\S* said last:\nno way"):
        processes.run_command(fails, os.environ)
    assert processes.run_command(fails, os.environ, codes=(0, 3)).code == 3


def test_who_has_ended_is_told_with_what_it_said(processes):
    started = processes.start([sys.executable, "-c", "print('bye')"], os.environ, "greeter")
    started.popen.wait(60)
    with pytest.raises(SourceError, match=r"greeter ended with 0\nbye"):
        started.check()


@pytest.mark.parametrize(
    ("number", "before"),
    [
        *[(each, "") for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)],
        *[(each, IGNORE) for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)],
    ],
)
def test_a_runner_that_ends_leaves_nothing_behind(tmp_path, number, before):
    text = before + RUNNER.format(commands=[SLEEP, LEFT_BEHIND, SLEEP], sleep=SLEEP)
    runner = subprocess.Popen(
        [sys.executable, "-c", text, str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    pids = [int(line) for line in iter(runner.stdout.readline, "all\n")]
    pids.append(int(wait_for(lambda: log(tmp_path, "02"), what="the orphan's pid")))
    wait_for(lambda: log(tmp_path, "04"), what="the last command")
    runner.send_signal(number)
    runner.communicate(timeout=60)
    assert len(pids) == 4
    assert not any(map(lives, pids))


def test_an_interrupted_runner_says_that_it_ends():
    text = "from rtron.demos.runtime.signals import interrupt_on_signals\n"
    text += "import signal\nwith interrupt_on_signals(): signal.raise_signal(signal.SIGTERM)\n"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, check=False)
    assert done.returncode == -signal.SIGINT
    assert done.stderr.decode().startswith("\nending what was started…\n")


def test_whom_nohup_started_outlives_its_terminal():
    text = "from rtron.demos.runtime.signals import defer_signals, interrupt_on_signals\n"
    text += "import signal\nsignal.signal(signal.SIGHUP, signal.SIG_IGN)\n"
    text += "with interrupt_on_signals(), defer_signals(): signal.raise_signal(signal.SIGHUP)\n"
    text += "print('on')"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert done.stdout == "on\n"


def test_impatience_does_not_stop_the_ending(tmp_path):
    text = RUNNER.format(commands=[DEAF, DEAF], sleep=SLEEP)
    short = "import rtron.demos.runtime.processes as p, signal as s\n"
    short += "p._TERMINATION_STEPS = ((s.SIGINT, 2), (s.SIGKILL, 10))\n"
    runner = subprocess.Popen(
        [sys.executable, "-c", short + text, str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    pids = [int(line) for line in iter(runner.stdout.readline, "all\n")]
    wait_for(lambda: log(tmp_path, "01") and log(tmp_path, "02") and log(tmp_path, "03"))
    while runner.poll() is None:
        runner.send_signal(signal.SIGINT)
        runner.send_signal(signal.SIGTERM)
        with suppress(subprocess.TimeoutExpired):
            runner.wait(0.1)
    runner.communicate(timeout=60)
    assert not any(map(lives, pids))


def log(folder, number):
    return "".join(path.read_text() for path in folder.glob(f"{number}-*.log"))
