"""Under Enforce nobody but the guard reaches the driver, and the app goes on meanwhile."""

import json
import re
import sys

import pytest
from cyclone_rmw import needs_security
from harness import wait_for
from ros2_harness import NODES2

pytest.importorskip("rclpy", reason="needs ROS 2")
from keystores import forge
from secured_app import EVIL, NAV, OUT, SPEED, SecuredApp, speeds, wait_for_commands

pytestmark = [pytest.mark.ros2, needs_security]
ALARMS = re.compile("foreign|intrusion|impostor|unapproved|past the guard")
NAVIGATION = ("twist_publisher.py", NAV, SPEED, "50")
ATTACK = ("twist_publisher.py", OUT, EVIL, "200", "1000")


@pytest.fixture
def app(ros2):
    return SecuredApp(ros2)


def test_intruders_at_200_hz_reach_nobody_and_the_app_goes_on(ros2, app):
    driver, guard = app.driver(), app.guard()
    app.nav()
    wait_for_commands(driver)
    stranger = ros2.node(*ATTACK, name="/stranger")
    impostor = ros2.node(*ATTACK, name="/rtron/grcn_cmd_vel")
    insider = spawned(app, "/nav")
    driven = spawned(app, "/driver")
    own = {"ROS_SECURITY_KEYSTORE": str(forge(ros2.folder / "own", app.keystore, ros2.domain))}
    forger = app.node(*ATTACK, name="/forger", enclave="/nav", environ=app.environ | own)
    attackers = (stranger, impostor, forger)
    wait_for(lambda: all("said all" in each.log for each in attackers), 60, "the attack")
    wait_for(lambda: insider.ended and driven.ended, 30, "the refusal")
    wait_for_commands(driver)
    assert speeds(driver)[EVIL] == 0
    assert "ready" not in insider.log + driven.log
    assert not ALARMS.search(guard.log), guard.log


def spawned(app, enclave):
    """Start an intruder with the enclave of a node, which may not publish what the driver reads."""
    script, *arguments = ATTACK
    environ = {**app.environ, "ROS_SECURITY_ENCLAVE_OVERRIDE": enclave}
    return app.ros2.spawn(sys.executable, NODES2 / script, *arguments, **environ)


def verified(ros2, app, *options):
    ran = ros2.rtron(
        "verify",
        "--live",
        "--plan",
        app.plan,
        "--keystore",
        app.keystore,
        "--format",
        "json",
        *options,
    )
    wait_for(lambda: ran.ended, 90, "the verification")
    return json.loads(ran.log[ran.log.index("{") :])


def test_verify_proves_that_it_is_in_force_and_finds_who_has_no_certificate(ros2, app):
    driver = app.driver()
    app.guard()
    app.nav()
    wait_for_commands(driver)
    found = verified(ros2, app)
    assert (found["verdict"], found["problems"]) == ("closed", [])
    assert found["proven"] == [
        f"the enclave /rtron_verify may not publish {OUT}",
        "a participant without a certificate sees nobody",
    ]
    ros2.node("twist_publisher.py", "/odom", "1.0", "5", name="/unsafe")
    found = verified(ros2, app)
    assert found["verdict"] == "open"
    assert any("/unsafe is there without a certificate" in each for each in found["problems"])


def test_processes_that_start_as_in_a_guarded_launch_speak_through_the_guard(ros2, app):
    script, nodes = app.start_script(), {}
    app.guard()
    for name, *words in (("driver", "twist_subscriber.py", OUT), ("nav", *NAVIGATION)):
        program, *arguments = words
        command = (sys.executable, NODES2 / program, *arguments)
        rules = ("--ros-args", "-r", f"__node:={name}", "-r", "__ns:=/")
        nodes[name] = ros2.spawn(script, *command, *rules, **app.environ)
    wait_for(lambda: speeds(nodes["driver"])[SPEED] > 50, 30, "the navigation")
    assert "RTron:" not in nodes["driver"].log + nodes["nav"].log


def test_the_running_app_is_scanned_with_its_own_enclave(ros2, app):
    app.driver()
    app.guard()
    app.nav()
    app.ros2.environ |= app.environ
    scan = ros2.rtron("scan", "--live", "--ros", "2", "--format", "graph", "--fail-on", "never")
    wait_for(lambda: scan.ended, 90, "the scan")
    graph = json.loads(scan.log[scan.log.index("{") :])
    assert {"/nav", "/driver", "/rtron_guard"} <= {node["name"] for node in graph["nodes"]}


def test_without_its_enclave_the_guard_does_not_start_and_says_why(ros2, app):
    (app.keystore / "enclaves/rtron_guard/key.pem").unlink()
    ros2.environ |= app.environ
    guard = ros2.rtron("guard", "--plan", app.plan)
    wait_for(lambda: "ROS_SECURITY_KEYSTORE" in guard.log, 60, "the reason")
    assert "guarding" not in guard.log
