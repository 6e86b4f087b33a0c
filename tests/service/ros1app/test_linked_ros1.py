"""A real app under guard, and the service that it is linked to: both as their users run them."""

import pytest
from drive import CMD_VEL, CMD_VEL_GUARD, Driven, drive_plan, start_guard
from harness import NODES, ROS_PYTHON, wait_for

from bench.served import Served

pytestmark = pytest.mark.ros1
ROBOT = "r1"
OUT = f"/rtron{CMD_VEL}/out"


class App:
    """The driven base under a guard that is linked to a service."""

    def __init__(self, ros1, service):
        self.ros1, self.service = ros1, service
        self.driven = Driven(ros1.folder / "driven.txt")
        self.token = service.token(ROBOT, "guard", robot=ROBOT)
        self.guard = self.start_guard()
        driver = [ROS_PYTHON, NODES / "driver.py", self.driven.path, "__name:=driver"]
        ros1.spawn(*driver, f"{CMD_VEL}:={OUT}")
        wait_for(lambda: ros1.subscribers(OUT), what="the driver")

    def start_guard(self):
        words = ["--service", self.service.url, "--token-file", self.token, "--robot", ROBOT]
        state = self.ros1.folder / "state"
        return start_guard(self.ros1, drive_plan(), CMD_VEL_GUARD, *words, "--state", state)

    def navigate(self):
        nav = self.ros1.node("nav.py", "/nav", f"{CMD_VEL}:=/rtron{CMD_VEL}/flow1")
        wait_for(self.driven.navigation, what="navigation at the driver")
        return nav

    def robot(self):
        return self.service.state(ROBOT)

    def stream(self):
        robot = self.robot()
        return (robot["state"]["streams"] or [{}])[0] if robot and robot["state"] else {}

    def events(self, **filters):
        query = "&".join(f"{key}={value}" for key, value in filters.items())
        return self.service.ask(f"/api/v1/events?robot={ROBOT}&{query}")["events"]

    def verdicts(self, flow):
        return [each for each in self.events(kind="verdict") if each["flow"] == flow]

    def outcome(self):
        return self.service.ask(f"/api/v1/robots/{ROBOT}/settings")

    def change(self, **flows):
        view = self.service.change(ROBOT, {"grcn_cmd_vel": {"flows": flows}})
        wait_for(lambda: self.outcome()["outcome"] != "pending", what="the guard's answer")
        assert self.outcome()["outcome"] == "applied", self.outcome()
        return view["revision"]


@pytest.fixture
def service(tmp_path):
    with Served(tmp_path) as service:
        yield service


@pytest.fixture
def app(ros1, service):
    return App(ros1, service)


def test_who_is_in_control_is_to_be_seen(app):
    app.navigate()
    wait_for(lambda: app.stream().get("owner") == "flow1", what="the owner in the state")
    assert app.stream()["publisher"] == "/nav"
    wait_for(lambda: app.events(kind="owner"), what="the change of owner")
    assert app.events(kind="guard")[-1]["reason"] == "the guard begins"
    wait_for(lambda: app.events(kind="counts"), what="the counts")


def test_a_blocked_flow_stops_the_base_and_says_why(app):
    app.navigate()
    revision = app.change(flow1={"block": True})
    wait_for(lambda: app.driven.messages()[-1] == ("0", "0"), what="the stop")
    assert app.robot()["revision"] == revision
    blocked = wait_for(lambda: app.events(kind="verdict", level="warning"), what="the verdict")
    assert "block" in blocked[0]["reason"]
    assert blocked[0]["revision"] == revision
    heard = len(app.driven.navigation())
    app.change(flow1={"block": None})
    wait_for(lambda: len(app.driven.navigation()) > heard, what="navigation again")


def test_an_emergency_stop_holds_through_a_restart_of_the_guard(app):
    app.navigate()
    app.service.ask(f"/api/v1/robots/{ROBOT}/stop", "POST", {"reason": "smoke"})
    wait_for(lambda: app.driven.messages()[-1] == ("0", "0"), what="the stop")
    app.guard.kill()
    app.start_guard()
    wait_for(lambda: app.robot()["connected"] and app.stream().get("stopping"), what="the state")
    assert "smoke" in app.stream()["stopping"]
    heard = len(app.driven.navigation())
    app.service.ask(f"/api/v1/robots/{ROBOT}/stop", "DELETE", {"reason": "it was steam"})
    wait_for(lambda: len(app.driven.navigation()) > heard, what="navigation again")


def test_the_service_may_be_away(app):
    app.navigate()
    app.change(flow2={"block": True})
    app.service.stop()
    heard = len(app.driven.navigation())
    wait_for(lambda: len(app.driven.navigation()) > heard + 5, what="navigation meanwhile")
    app.ros1.node("rogue.py", "/rogue", "50", f"{CMD_VEL}:=/rtron{CMD_VEL}/flow2")
    wait_for(lambda: app.ros1.received(CMD_VEL_GUARD, f"/rtron{CMD_VEL}/flow2"), what="the rogue")
    assert app.driven.turns() == 0
    app.service.start()
    told = wait_for(lambda: app.verdicts("flow2"), what="what happened meanwhile")
    assert [each["decision"] for each in told] == ["drop"]
