"""What is no intrusion: nodes, guard and master come and go. And nodes that answer badly."""

import threading
from contextlib import ExitStack
from dataclasses import replace
from xmlrpc.server import SimpleXMLRPCServer

import pytest
from audit_scene import OUT, Scene, ghost, wait_until_found
from driven_base import CMD_VEL, CMD_VEL_GUARD, drive_plan
from faulty_nodes import garbage, never_answer, saying, stranger
from harness import wait_for

from rtron.vocabulary import Plan
from rtron.vocabulary.names import SUPERVISOR_NODE
from rtron.wire.ros1.xmlrpc import ros_call

pytestmark = pytest.mark.ros1


@pytest.mark.parametrize("rounds", [2, pytest.param(15, marks=pytest.mark.long)])
def test_an_app_that_comes_and_goes_is_no_alarm(ros1, roscpp_driver, rounds):
    with Scene(ros1, roscpp_driver) as scene:
        nav = scene.navigate()
        for number in range(rounds):
            echo = ros1.spawn("rostopic", "echo", CMD_VEL)
            stop = scene.driver.stop if number % 2 else scene.driver.kill
            stop()
            scene.drive()
            nav.stop() if number % 2 else nav.kill()
            nav = scene.navigate()
            heard = len(scene.driven.navigation())
            wait_for(lambda h=heard: len(scene.driven.navigation()) > h, what="navigation")
            echo.stop()
        assert scene.of_the_audit() == []


@pytest.mark.parametrize("kind", ["rospy", pytest.param("roscpp", marks=pytest.mark.long)])
def test_a_restarted_guard_finds_nobody_foreign(ros1, roscpp_driver, kind):
    with Scene(ros1, "driver.py" if kind == "rospy" else roscpp_driver) as scene:
        for stop in ("kill", "stop"):
            getattr(scene.guard, stop)()
            scene.log.close()
            again = Scene(ros1, scene._program, drives=False)
            again.driver = scene.driver
            scene = again  # noqa: PLW2901 - the next guard of the same base
            wait_for(scene.driver_hears_guard, what="the driver's connection to the next guard")
            assert scene.of_the_audit() == []
            with ghost(scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD)) as intruder:
                wait_until_found(scene, intruder, "ghost publisher")
            wait_for(lambda s=scene: s.of_the_audit("no more: ghost"), what="the ghost's end")
            assert len(scene.of_the_audit()) == 1
        scene.log.close()


@pytest.mark.long
def test_a_restarted_master_is_no_alarm_and_blinds_nobody(ros1):
    with Scene(ros1, "driver.py") as scene:
        uri = scene.driver_uri()
        wait_for(lambda: scene.hears(SUPERVISOR_NODE), what="the supervisor's connection")
        wait_for(scene.is_audited, what="the audit, which then knows the driver's address")
        ros1.master.kill()
        with ghost(uri) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
        wait_for(lambda: scene.alarms("no more: ghost"), what="the ghost's end")
        ros1.start_master()
        wait_for(lambda: CMD_VEL_GUARD in ros1.publishers(OUT), what="the guard's return")
        with ghost(uri) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
        wait_for(lambda: len(scene.alarms("no more: ghost")) == 2, what="the ghost's end")
        told = [each for each in scene.of_the_audit() if not any(w in each for w in NO_MASTER)]
        assert len(told) == 2, "what a busy driver and no master leave unseen is told, too"


NO_MASTER = ("unseen: the master does not answer", "the master does not tell where it lives")
"""Alarms that are right when a master has been away for 5 s, and a busy driver did not answer."""


class HangingMaster:
    """Takes every call and answers none, at the place of a master that was."""

    def __init__(self, uri):
        self._server = SimpleXMLRPCServer(("localhost", int(uri.rpartition(":")[2])))
        self._over = threading.Event()
        self._server.register_instance(self)
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def _dispatch(self, *_):
        self._over.wait()
        return [0, "", 0]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._over.set()
        self._server.shutdown()
        self._server.server_close()


def test_a_master_that_hangs_blinds_nobody(ros1):
    """The first ghost shows that the audit has found the driver, for which it needs the master."""
    with Scene(ros1, "driver.py") as scene:
        uri = scene.driver_uri()
        wait_for(lambda: scene.hears(SUPERVISOR_NODE), what="the supervisor's connection")
        with ghost(uri) as first:
            wait_until_found(scene, first, "ghost publisher")
        ros1.master.kill()
        with HangingMaster(ros1.uri), ghost(uri) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
        usual = (": ghost publisher:", *NO_MASTER)
        assert [each for each in scene.of_the_audit() if not any(w in each for w in usual)] == []


def with_wheels(number) -> Plan:
    plan = drive_plan()
    wheels = tuple(f"/wheel_{index}" for index in range(number))
    (node,) = plan.grcn
    return replace(plan, grcn=(replace(node, successors=(*node.successors, *wheels)),))


BAD = {
    "garbage": garbage,
    "silence": never_answer,
    "no XML": saying(b"<" * 99),
    "a bomb": saying(b'<!DOCTYPE x [<!ENTITY a "b">]><methodResponse>&a;</methodResponse>'),
    "deep": saying(b"<value><array><data>" * 5000),
    "large": saying(b" " * (1 << 23)),
}


def test_nodes_that_answer_badly_are_told_and_delay_nobody(ros1):
    plan = with_wheels(len(BAD))
    with Scene(ros1, "driver.py", plan) as scene, ExitStack() as stack:
        for index, answer in enumerate(BAD.values()):
            uri = stack.enter_context(stranger(answer))
            words = (f"/wheel_{index}", OUT, "geometry_msgs/Twist", uri)
            ros_call(ros1.uri, "registerSubscriber", *words, timeout=30)
        wheels = [f"unseen: /wheel_{index} cannot be audited" for index in range(len(BAD))]
        told = lambda: [len(scene.alarms(wheel)) for wheel in wheels]  # noqa: E731 - for two looks
        wait_for(lambda: all(told()), what="the alarms")
        with ghost(scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD)) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
        assert "Traceback" not in scene.guard.log
        assert told() == [1] * len(BAD), "each once, whatever a busy driver leaves unseen"
