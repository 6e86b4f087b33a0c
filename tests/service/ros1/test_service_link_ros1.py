"""A real app under guard, and the service that it is linked to: both as their users run them."""

import os
import signal

import pytest
from driven_base import CMD_VEL_GUARD
from harness import wait_for
from linked_app import FLOW2, ROBOT, LinkedApp

from bench.service.service_process import ServiceProcess

pytestmark = pytest.mark.ros1


@pytest.fixture
def service(tmp_path):
    with ServiceProcess(tmp_path) as service:
        yield service


@pytest.fixture
def app(ros1, service):
    return LinkedApp(ros1, service)


@pytest.mark.long
def test_who_is_in_control_is_to_be_seen(app):
    app.navigate()
    wait_for(lambda: app.stream().get("owner") == "flow1", what="the owner in the state")
    assert app.stream()["publisher"] == "/nav"
    wait_for(lambda: app.events(kind="owner"), what="the change of owner")
    assert app.events(kind="guard")[-1]["reason"] == "the guard begins"
    wait_for(lambda: app.events(kind="counts"), what="the counts")


@pytest.mark.long
def test_a_blocked_flow_stops_the_base_and_says_why(app):
    app.navigate()
    revision = app.change(flow1={"block": True})
    wait_for(app.rests, what="the stop")
    assert app.robot()["revision"] == revision
    blocked = wait_for(lambda: app.events(kind="verdict", level="warning"), what="the verdict")
    assert "block" in blocked[0]["reason"]
    assert blocked[0]["revision"] == revision
    heard = len(app.driven.navigation())
    app.change(flow1={"block": None})
    wait_for(lambda: len(app.driven.navigation()) > heard, what="navigation again")


def test_an_emergency_stop_holds_through_a_restart_of_the_guard(app):
    app.navigate()
    app.service.request(f"/api/v1/robots/{ROBOT}/stop", "POST", {"reason": "smoke"})
    wait_for(app.rests, what="the stop")
    app.guard.kill()
    app.start_guard()
    wait_for(lambda: app.robot()["connected"] and app.stream().get("stopping"), what="the state")
    assert "smoke" in app.stream()["stopping"]
    heard = len(app.driven.navigation())
    body = {"reason": "it was steam", "revision": app.robot()["revision"]}
    app.service.request(f"/api/v1/robots/{ROBOT}/stop", "DELETE", body)
    wait_for(lambda: len(app.driven.navigation()) > heard, what="navigation again")


def test_an_emergency_stop_arrives_although_the_link_process_stands_still(app):
    app.navigate()
    link = int(app.process("rtron-link"))
    os.kill(link, signal.SIGSTOP)
    answer = app.service.request(f"/api/v1/robots/{ROBOT}/stop", "POST", {"reason": "smoke"})
    assert answer["outcome"] == "pending"
    wait_for(app.rests, what="the stop")
    assert "rtron-link stands still: it is killed" in app.guard.log


@pytest.mark.long
def test_the_service_may_be_away(app):
    app.navigate()
    app.change(flow2={"block": True})
    app.service.stop()
    heard = len(app.driven.navigation())
    wait_for(lambda: len(app.driven.navigation()) > heard + 5, what="navigation meanwhile")
    app.attack()
    wait_for(lambda: app.ros1.received(CMD_VEL_GUARD, FLOW2), what="the rogue")
    assert app.driven.turns() == 0
    app.service.start()
    told = wait_for(lambda: app.verdicts("flow2"), what="what happened meanwhile")
    assert [each["decision"] for each in told] == ["drop"]
