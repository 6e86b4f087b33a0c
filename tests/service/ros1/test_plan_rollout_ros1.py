"""A roll-out brings a real guard another plan, which it takes, refuses, or goes back from."""

import os
import signal
from dataclasses import replace
from urllib.error import HTTPError

import pytest
from driven_base import CMD_VEL_GUARD, drive_plan, start_guard
from harness import wait_for
from linked_app import ROBOT, LinkedApp

from bench.service.service_process import ServiceProcess
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import GUARD_NODE

pytestmark = pytest.mark.ros1
ANYTHING = dict.fromkeys(["alarm", "blocked", "stopped"], "100%")


class PlannedApp(LinkedApp):
    """The base with a guard that takes plans, unless `takes_plans` says no."""

    def __init__(self, ros1, service, *, takes_plans=True):
        self.plans = ros1.folder / "plans"
        self.words = ["--plans", self.plans] if takes_plans else []
        super().__init__(ros1, service)
        wait_for(lambda: (self.robot() or {}).get("connected"), what="the guard's connection")
        self.navigate()

    def start_guard(self):
        words = ["--service", self.service.url, "--token-file", self.token, "--robot", ROBOT]
        words += ["--state-dir", self.ros1.folder / "state", *self.words]
        return start_guard(self.ros1, self.plan, CMD_VEL_GUARD, *words)

    def roll_out(self, plan, **limits):
        body = {
            "robots": {"names": [ROBOT]},
            "plan": write_plan(plan),
            "reason": "a test",
            "wait": 1,
            "limits": limits,
            "answer_within": 60,
        }
        return self.service.request("/api/v1/rollouts", "POST", body)["id"]

    def wait_for_state(self, id, state):
        is_there = lambda: self.view(id)["state"] == state  # noqa: E731
        wait_for(is_there, what=f"the roll-out {state}", show=lambda: self.view(id))

    def wait_until_applied(self, id):
        is_there = lambda: self.view(id)["applied"] == 1  # noqa: E731
        wait_for(is_there, what="the plan in force", show=lambda: self.view(id))

    def is_applied(self):
        return self.outcome()["outcome"] == "applied"

    def view(self, id):
        return self.service.request(f"/api/v1/rollouts/{id}")

    def guard_pid(self):
        return self.ros1.ask(self.ros1.uri_of(GUARD_NODE), "getPid")

    def wait_for_navigation(self):
        heard = len(self.driven.navigation())
        wait_for(lambda: len(self.driven.navigation()) > heard, what="navigation again")


def blocking_plan():
    """Return the plan of the base with the navigation blocked."""
    plan = drive_plan()
    (node,) = plan.grcn
    mover, other = node.flows
    return replace(plan, grcn=(replace(node, flows=(replace(mover, block=True), other)),))


def kinder_plan():
    """Return a plan under which nothing that happens here is other than before."""
    plan = drive_plan()
    (node,) = plan.grcn
    mover, other = node.flows
    return replace(plan, grcn=(replace(node, flows=(replace(mover, priority=7), other)),))


def moved_plan():
    plan = drive_plan()
    return replace(plan, grcn=(replace(plan.grcn[0], successors=("/other",)),))


@pytest.fixture
def service(tmp_path):
    with ServiceProcess(tmp_path) as service:
        yield service


def test_a_guard_takes_a_harmless_plan_without_a_problem_and_gives_it_back(ros1, service):
    """Long: three guards begin, and each of two plans is on trial for 5 s."""
    app = PlannedApp(ros1, service)
    first = app.guard_pid()
    id = app.roll_out(kinder_plan())
    wait_for(lambda: app.view(id)["state"] != "running", what="the end of the roll-out")
    view = app.view(id)
    assert (view["state"], view["applied"], view["problems"]) == ("done", 1, {})
    assert app.guard_pid() != first
    app.wait_for_navigation()
    assert (app.plans / "plan.yaml").read_text() == write_plan(kinder_plan())
    service.request(f"/api/v1/rollouts/{id}/cancel", "POST", {"reason": "enough"})
    wait_for(lambda: not (app.plans / "plan.yaml").exists(), what="the plan of the start")
    wait_for(app.is_applied, what="the answer", show=app.outcome)
    assert app.outcome()["settings"]["plan"] == ""


@pytest.mark.long
def test_another_plan_obeys_an_emergency_stop_and_is_in_force_after_a_start(ros1, service):
    app = PlannedApp(ros1, service)
    service.request(f"/api/v1/robots/{ROBOT}/stop", "POST", {"reason": "smoke"})
    wait_for(app.rests, what="the stop")
    app.wait_until_applied(app.roll_out(blocking_plan(), **ANYTHING))
    wait_for(lambda: "smoke" in app.stream().get("stopping", ""), what="the stop of before")
    app.guard.stop()
    app.start_guard()
    wait_for(lambda: app.robot()["connected"] and app.stream(), what="the guard's state")
    body = {"reason": "it was steam", "revision": app.robot()["revision"]}
    service.request(f"/api/v1/robots/{ROBOT}/stop", "DELETE", body)
    wait_for(app.is_applied, what="the settings", show=app.outcome)
    assert app.outcome()["settings"]["plan"]
    assert app.rests()


@pytest.mark.long
def test_a_guard_that_ends_with_the_plan_gives_place_to_the_former_one(ros1, service):
    app = PlannedApp(ros1, service)
    first = app.guard_pid()
    id = app.roll_out(kinder_plan(), alarm="100%")
    wait_for(lambda: app.guard_pid() not in (first, None), what="the next guard")
    os.kill(app.guard_pid(), signal.SIGKILL)
    app.wait_for_state(id, "reverted")
    assert "refused: 1 of 1 robots" in app.view(id)["note"]
    app.wait_for_navigation()
    wait_for(app.is_applied, what="the answer", show=app.outcome)
    assert app.outcome()["settings"]["plan"] == ""
    assert not (app.plans / "plan.yaml").exists()


@pytest.mark.long
def test_a_plan_that_needs_a_launch_or_a_guard_that_takes_none_is_refused(ros1, service):
    app = PlannedApp(ros1, service, takes_plans=False)
    first = app.guard_pid()
    with pytest.raises(HTTPError) as caught:
        app.roll_out(moved_plan())
    assert caught.value.code == 422
    assert b"needs a new launch" in caught.value.read()
    app.wait_for_state(app.roll_out(blocking_plan()), "reverted")
    assert app.guard_pid() == first
