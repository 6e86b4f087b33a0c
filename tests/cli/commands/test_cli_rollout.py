"""`rtron rollout` against a real service, with guards on the real link."""

import json
import shutil
import signal
import subprocess
import sys
from contextlib import contextmanager
from functools import partial

import pytest
from controller_setup import PLAN, hello, plan
from harness import wait_for
from rollout_guards import AnsweringGuard
from service_app import AccountFactory, serve_in_thread

from bench.service.service_process import ServiceProcess
from rtron.cli.commands import rollout
from rtron.cli.support.rollout_report import PROBLEMS, rollout_line
from rtron.service.config import ServiceConfig
from rtron.service.controller.handshake import perform_handshake
from rtron.service.domain.rollouts.schemas import Problem
from rtron.service.server.app import create_app
from rtron.service.store.database import Database
from rtron.service.store.fleet.labels import replace_members
from rtron.service.store.robots import find_robot
from rtron.wire.common.link_protocol import plan_document_digest

ROBOTS = [f"car{index}" for index in range(5)]
SOON = ("--stages", "1,100%", "--wait", "0")
CHANGE = ("rollout", "start", "drive", "policy=Block", "--reason", "visitors")
LATER = (*CHANGE, "--group", "hall-a", "--wait", "1h")


class Hall:
    """A service, and the guards of hall A."""

    def __init__(self, app, port):
        self.port, self.people = port, AccountFactory(app.state.service)
        self.guards = [
            AnsweringGuard(port, robot, self.people.token_headers(robot, "guard", robot=robot))
            for robot in ROBOTS
        ]
        service = app.state.service
        wait_for(lambda: all(service.hub.state(robot) for robot in ROBOTS))
        with service.database.session() as session:
            ids = [find_robot(session, robot)[0].id for robot in ROBOTS]
            replace_members(session, "hall-a", ids)


@contextmanager
def open_hall(file):
    app = create_app(ServiceConfig(database=file))
    with serve_in_thread(app) as port:
        hall = Hall(app, port)
        yield hall
        for guard in hall.guards:
            guard.close()


@pytest.fixture
def hall(database_file):
    with open_hall(database_file) as hall:
        yield hall


@pytest.fixture(scope="module")
def unchanged_hall(tmp_path_factory, migrated_file):
    """A hall for all that is refused."""
    with open_hall(shutil.copy(migrated_file, tmp_path_factory.mktemp("hall"))) as hall:
        yield hall


@pytest.fixture
def run_as(rtron, tmp_path):
    """Run a command at a hall's service as somebody with a role."""

    def run(hall, *words, role="developer"):
        path = tmp_path / f"{role}.token"
        if not path.exists():
            header = hall.people.token_headers("me", role)["Authorization"]
            path.write_text(header.removeprefix("Bearer "))
        return rtron(*words, "--service", f"http://127.0.0.1:{hall.port}", "--token-file", path)

    return run


@pytest.fixture
def call(run_as, hall):
    return partial(run_as, hall)


@pytest.fixture
def refused_call(run_as, unchanged_hall):
    """Run a command that changes nothing."""
    yield (call := partial(run_as, unchanged_hall))
    assert call("rollout", "list").out == ""


def test_a_good_change_is_followed_to_the_last_robot(call):
    ran = call(*CHANGE, "--group", "hall-a", *SOON, "--follow")
    lines = ran.out.splitlines()
    assert (ran.code, ran.err) == (0, "")
    assert lines[0].startswith("roll-out 1: running; stage 1 of 2; ")
    assert lines[-1] == "roll-out 1: done; 5 of 5 have the change (5 in force)"


def test_a_bad_change_goes_back_and_says_why(call, hall):
    for guard in hall.guards:
        guard.is_bad = True
    ran = call(*CHANGE, "--app", "small", "--follow", "--format", "json")
    views = list(map(json.loads, ran.out.splitlines()))
    assert (ran.code, views[-1]["state"], views[-1]["reverted"]) == (1, "reverted", 1)
    canary = call("rollout", "show", "1", "--robots", "--format", "json").out
    robots = json.loads(canary)["robots"]
    assert [each["phase"] for each in robots] == ["reverted", *["waiting"] * 4]
    note = f"alarm: 1 of 1 robots, at most 0: {robots[0]['robot']}"
    shown = call("rollout", "show", "1", "--robots")
    assert shown.code == 0
    assert f"  {note}\n" in shown.out
    assert f"  {robots[0]['robot']}  reverted  applied  alarm\n" in shown.out
    assert "  alarm      1 robot, at most 0    a new alarm\n" in shown.out
    (line,) = call("rollout", "list", role="read").out.splitlines()
    assert line.startswith("1  WENT BACK  0 of 5 have the change, 1 without it again  ")
    assert line.endswith(note)


def test_pause_resume_and_cancel(call):
    started = json.loads(call(*LATER, "--format", "json").out)
    id = str(started["id"])
    assert started["policy"]["wait"] == 3600
    paused = call("rollout", "pause", id, "--reason", "lunch")
    assert (paused.code, paused.out.startswith("roll-out 1: PAUSED; stage 1 of 2; ")) == (0, True)
    assert paused.out.endswith("; token:me.5: lunch\n")
    again = call("rollout", "pause", id, "--reason", "lunch")
    assert (again.code, "roll-out 1 is paused" in again.err) == (2, True)
    assert "running" in call("rollout", "resume", id, "--reason", "back").out
    kept = call("rollout", "cancel", id, "--keep", "--reason", "enough", "--format", "json")
    assert json.loads(kept.out)["state"] == "cancelled"
    assert call("rollout", "show", id, "--follow").code == 1


def test_a_change_is_taken_back(call):
    call(*CHANGE, *SOON, *(word for robot in ROBOTS for word in ("--robot", robot)), "-f")
    assert "GOING BACK" in call("rollout", "cancel", "1", "--reason", "it brakes").out
    ran = call("rollout", "show", "1", "--follow")
    assert ran.code == 1
    assert "WENT BACK; stage 2 of 2; 0 of 5 have the change (0 in force), 5 without" in ran.out


def test_the_change_and_the_stages_are_shown(call):
    words = ["policy=Priority_Queue", "flow1.priority=3", "flow2.timeout=plan"]
    options = ["--stages", "2,40%,60%,100%", "--wait", "1h", "--limit", "gone=1"]
    call("rollout", "start", "drive", *words, "--app", "small", "--reason", "x y", *options)
    wait_for(lambda: "2 of 5 have" in call("rollout", "show", "1").out)
    out = call("rollout", "show", "1").out
    assert "  drive  policy          Priority_Queue\n" in out
    assert "  drive  flow1.priority  3\n" in out
    assert "  drive  flow2.timeout   as the plan\n" in out
    assert "  1  up to 2  2 reached\n  2  up to 3\n  3  up to 5\n" in out
    assert "  gone       0 robots, at most 1  the guard is away" in out
    assert "  stopped    0 robots, at most 0  stopped, by" in out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((*CHANGE,), "which robots?"),
        ((*CHANGE, "--robot", "car1", "--group", "hall-a"), "which robots?"),
        ((*CHANGE, "--group", "hall-b"), "there is no such robot"),
        ((*CHANGE, "--robot", "car9"), "there is no such robot"),
        ((*LATER, "--limit", "alarms=0"), "did you mean alarm?"),
        ((*LATER, "--limit", "alarm"), "give PROBLEM=AMOUNT"),
        ((*LATER, "--limit", "alarm=few"), 'a share such as "10%"'),
        ((*LATER, "--limit", f"alarm={'9' * 5000}"), 'a share such as "10%"'),
        ((*LATER, "--stages", "1,10%"), 'the last stage is "100%"'),
        ((*LATER, "--stages", "1,,100%"), 'a share such as "10%"'),
        ((*LATER, "--answer-within", "soon"), "--answer-within"),
        (("rollout", "start", "drve", "policy=Block", *LATER[4:]), "no such coordination node"),
        (("rollout", "start", "drive", "polcy=Block", *LATER[4:]), "did you mean policy?"),
        (("rollout", "show", "7"), "there is no roll-out 7"),
        (("rollout", "cancel", "7", "--reason", "none"), "there is no roll-out 7"),
    ],
)
def test_what_is_refused_has_help(refused_call, words, told):
    ran = refused_call(*words)
    assert (ran.code, ran.out) == (2, "")
    assert told in ran.err


def test_it_takes_the_rights_of_the_change(refused_call):
    ran = refused_call(*LATER, role="end_user")
    assert (ran.code, "may not select_policy at drive" in ran.err) == (2, True)


@pytest.mark.parametrize("command", ["start", "list", "show", "pause", "resume", "cancel"])
def test_each_command_shows_an_example(rtron, command):
    page = rtron("rollout", command, "-h")
    assert f"$ rtron rollout {command}" in page.out
    assert max(map(len, page.out.splitlines())) <= 80


def test_problems_are_those_of_the_service(rtron):
    assert list(PROBLEMS) == [each.value for each in Problem]
    assert all(f"  {name} " in rtron("rollout", "start", "-h").out for name in PROBLEMS)


def test_a_shell_completes_limits_and_keys():
    assert dict(rollout._complete_limit("re")) == {
        "refused=": PROBLEMS["refused"],
        "restarted=": PROBLEMS["restarted"],
    }
    assert rollout.complete_setting("max_v") == ["max_vel_limit="]


def test_a_service_that_is_away_is_asked_again(tmp_path, database_file):
    """A roll-out of a robot that is off is followed over a kill of the service."""
    database = Database(database_file)
    with database.write_session() as session:
        perform_handshake(session, "car1", hello(plan()), now=1)
    database.close()
    with ServiceProcess(tmp_path, database_file) as service:
        new = {"robots": {"names": ["car1"]}, "nodes": {"drive": {"policy": "Block"}}}
        service.request("/api/v1/rollouts", "POST", new | {"reason": "visitors"})
        command = [sys.executable, "-m", "rtron", "rollout", "show", "1", "--follow"]
        where = ["--service", service.url, "--token-file", tmp_path / "measuring.token"]
        with subprocess.Popen([*command, *where], stdout=-1, stderr=-1, text=True) as process:
            try:
                assert process.stdout.readline().startswith("roll-out 1: running; ")
                service.stop(signal.SIGKILL)
                assert "the service is away, trying again: " in process.stderr.readline()
                service.start()
                service.request("/api/v1/rollouts/1/cancel", "POST", {"reason": "enough"})
                out, _ = process.communicate(timeout=60)
            finally:
                process.kill()
    assert "roll-out 1: WENT BACK; " in out
    assert process.returncode == 1


def test_names_of_strangers_are_made_harmless():
    view = {
        "id": 1,
        "state": "reverted",
        "stage": 0,
        "targets": [1],
        "total": 1,
        "sent": 0,
        "reverted": 1,
        "stuck": 0,
        "problems": {"alarm": 1},
        "note": "alarm: \x1b[2J\nroll-out 2: done",
    }
    assert rollout_line(view) == (
        "roll-out 1: WENT BACK; stage 1 of 1; 0 of 1 have the change, 1 without it again; "
        "shown: alarm on 1; alarm: \\x1b[2J\\nroll-out 2: done\n"
    )


PLANNED = ("rollout", "start", "--group", "hall-a", "--reason", "visitors", *SOON)


def test_a_plan_is_rolled_out_and_shown(call, tmp_path):
    path = tmp_path / "other.yaml"
    path.write_text(PLAN.replace("priority: 2", "priority: 3"))
    ran = call(*PLANNED, "--plan", path, "--follow")
    assert (ran.code, "5 of 5 have the change (5 in force)" in ran.out) == (0, True)
    assert f"the plan {plan_document_digest(path.read_text())}" in call("rollout", "show", "1").out


def test_a_plan_that_needs_a_launch_is_refused(refused_call, tmp_path):
    path = tmp_path / "other.yaml"
    path.write_text(PLAN.replace("/base]", "/base2]"))
    ran = refused_call(*PLANNED, "--plan", path)
    assert ran.code == 2
    assert "needs a new launch: grcn drive: successors" in ran.err
    assert "rtron instrument" in ran.err


@pytest.mark.parametrize("words", [(), ("drive", "policy=Block", "--plan", "x"), ("drive",)])
def test_a_change_is_of_settings_or_a_plan(refused_call, words):
    ran = refused_call(*PLANNED, *words)
    assert ran.code == 2
    assert "--plan" in ran.err
