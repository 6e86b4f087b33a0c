"""The case studies on a real ROS: studied once, and looked at by the tests of that ROS."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from uuid import uuid4

from harness import LIMIT_S, wait_for

from rtron.demos.cases import CASES
from rtron.demos.experiment.demonstration import DemoRequest, run_demo
from rtron.demos.experiment.study import ProgressListener, Study
from rtron.demos.metrics.case_run import Variant
from rtron.demos.runtime.environment import demo_environment

SEEDS = (1, 2, 3)
SPEED = 3.0
_MARK = "TEST_OF_ENDING"
_RUNNING = 9
"""So many processes are there when the app is starting."""


def run_study(ros, folder, *cases):
    """Return the study of cases in three worlds, without and with the guard."""
    with demo_environment(ros, folder, speed=SPEED) as surroundings:
        listener = ProgressListener(lambda now: None, lambda done: None)
        study = Study(surroundings, [CASES[case] for case in cases], SEEDS, listener)
        study.run_unguarded()
        with study.guarded_session():
            pass  # entering it runs every case
    return study


def run_recorded_demo(ros, folder):
    """Return the runs of all cases in one world as `rtron demo all` makes them, recorded."""
    wish = DemoRequest(cases=list(CASES.values()), seeds=SEEDS[:1], ros=ros, speed=SPEED)
    found = []
    tell = ProgressListener(lambda now: None, lambda done: None)
    run_demo(wish, folder, tell, lambda study, _: found.extend(study.runs))
    return found


EXPECTED = {
    "unattacked": ("completed", "not collided", "none sent", "none delivered"),
    "attacked": ("harmed", "sent", "delivered"),
    "guarded": ("completed", "not collided", "sent", "none delivered", "as fast as ever"),
}


def facts(study, case, seed):
    """Return what is true of a world's runs, by variant, in the words of EXPECTED."""
    calm, attacked, guarded = (study.runs_of(case, seed)[variant] for variant in Variant)
    fast = guarded.time_to_goal and guarded.time_to_goal <= 1.1 * calm.time_to_goal
    speed = "as fast as ever" if fast else guarded.time_to_goal
    harmed = "harmed" if attacked.harm else attacked.outcome
    return {
        "unattacked": (calm.outcome, collided(calm), *messages(calm)),
        "attacked": (harmed, *messages(attacked)),
        "guarded": (guarded.outcome, collided(guarded), *messages(guarded), speed),
    }


def collided(run):
    return "collided" if run.collided else "not collided"


def messages(run):
    sent = "sent" if run.sent else "none sent"
    return sent, "delivered" if run.delivered else "none delivered"


def check_ending(ros, folder, number):
    """Check that the demo, ended in the midst, leaves no process behind."""
    mark = uuid4().hex
    out = folder / "out"
    command = [sys.executable, "-m", "rtron", "demo", "gr", "--ros", str(ros), "-o", str(out)]
    ran = subprocess.Popen(command, env={**os.environ, _MARK: mark}, start_new_session=True)
    try:
        wait_for(lambda: len(marked_processes(mark)) >= _RUNNING or ran.poll() is not None)
        assert ran.poll() is None
        ran.send_signal(number)
        assert ran.wait(LIMIT_S) == 130
        assert marked_processes(mark) == []
    finally:
        for pid in marked_processes(mark):
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        ran.wait()


def marked_processes(mark):
    """Return the processes that the marked one has started, itself among them."""
    wanted = f"{_MARK}={mark}".encode()
    return [
        int(each.name) for each in Path("/proc").glob("[0-9]*") if wanted in environ_entries(each)
    ]


def environ_entries(folder):
    try:
        return (folder / "environ").read_bytes().split(b"\0")
    except OSError:
        return []
