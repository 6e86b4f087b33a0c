"""The case studies on a real ROS: what holds of them on either, in worlds that are run once."""

import json
import os
import signal
import subprocess
import sys
from collections import Counter, defaultdict
from contextlib import suppress
from pathlib import Path
from uuid import uuid4

import pytest
from harness import LIMIT_S, wait_for

from rtron.demos.cases import CASES
from rtron.demos.experiment.demonstration import DemoRequest, are_as_expected, run_demo
from rtron.demos.experiment.study import ProgressListener
from rtron.demos.metrics.case_run import Variant, decision_counts

SPEED = 3.0
_MARK = "TEST_OF_ENDING"
_RUNNING = 9
"""So many processes are there when the app is starting."""
STOPPED = {
    "gr": {"/tb3_safe_control": "drop", "unapproved": "drop"},
    "rsr": {"/tb3_monitor": "modify"},
    "msr": {"/tb3_monitor": "drop"},
    "agent": {"/bridge/assistant": "drop"},
}
"""What the guard does to whose messages, by case."""


def run_study(ros, folder, cases, seeds):
    """Return the study of cases in the worlds of seeds, without and with the guard."""
    request = DemoRequest(cases=[CASES[case] for case in cases], seeds=seeds, ros=ros, speed=SPEED)
    found = []
    listener = ProgressListener(lambda now: None, lambda done: None)
    run_demo(request, folder, listener, lambda study, _: found.append(study))
    return found[0]


class DemoBattery:
    """What holds on ROS `ros`; the fixture `study` has run the cases there."""

    ros = 0

    def test_the_attacks_do_harm_without_the_guard_and_none_with_it(self, study):
        assert are_as_expected(study.runs)
        assert not any(run.delivered for run in study.runs if run.variant is Variant.GUARDED)

    def test_where_no_limit_follows_the_camera_the_guarded_robot_is_as_fast_as_ever(self, study):
        worlds = {(run.case, run.seed) for run in study.runs}
        if "rsr" not in {case for case, _ in worlds}:  # which slows it while a machine is busy
            found = {world: facts(study, *world) for world in worlds}
            assert found == dict.fromkeys(worlds, EXPECTED), found

    def test_the_service_records_whom_the_guard_stops(self, study):
        for run in study.runs:
            if run.variant is Variant.GUARDED:
                sums = sums_by_publisher(run)
                stopped = {who: sums[who][how] for who, how in STOPPED[run.case].items()}
                assert min(stopped.values()) > 0, (run.case, run.seed, stopped)

    def test_a_node_that_is_started_by_hand_attacks_too(self, study):
        journal = study.pipeline.environment.journal / "safe_control_by_hand.jsonl"
        entries = map(json.loads, journal.read_text().splitlines())
        turns = [each for each in entries if each["value"] == [0.0, -0.2]]
        assert len(turns) > 50

    def test_the_commands_are_those_of_a_developer(self, study):
        commands = [ran.command.split()[1] for ran in study.commands]
        assert commands == ["scan", "scan", "plan", "check", "instrument"]
        assert "/tb3_safe_control both drive the robot on /cmd_vel" in study.commands[1].text

    @pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
    def test_ended_in_the_midst_it_leaves_no_process_behind(self, tmp_path, number):
        check_ending(self.ros, tmp_path, number)


def sums_by_publisher(run):
    """Return by publisher of the case's topic how many messages met which decision."""
    found = defaultdict(Counter)
    for each in decision_counts(run.events):
        if each.topic == CASES[run.case].topic:
            found[run.publishers.get((each.topic, each.flow), each.flow)].update(each.counts)
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
