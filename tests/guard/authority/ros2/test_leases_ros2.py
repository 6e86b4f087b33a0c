"""Leases between real nodes of ROS 2: who asks by its own name moves the base, nobody else."""

import json
import re
from dataclasses import replace

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from leased_base import AGENT, NAV, STRANGER, TELEOP
from rclpy_nodes import STRING, kept, twist
from ros2_plans import driving, written

from rtron.guard.core.report_messages import read_string, string_message
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    SECOND,
    CommanderRank,
    LeaseGroup,
    PolicyName,
    flow_topic,
    lease_topic,
    output_topic,
)

pytestmark = pytest.mark.ros2
TOPIC = "/cmd_vel"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
OUT = output_topic(TOPIC)
LONG, SHORT = 600 * SECOND, 2 * SECOND
RANKS = (CommanderRank.OPERATOR_ON_SITE, CommanderRank.AUTONOMY, CommanderRank.AGENT)


def leased_plan(ttl):
    base = driving("teleop", "nav", "agent", silent_after=3 * SECOND)
    flows = tuple(replace(flow, rank=rank) for flow, rank in zip(base.flows, RANKS, strict=True))
    base = replace(base, flows=flows, policy=PolicyName.LEASE, lease="base")
    return written(base, leases=(LeaseGroup(name="base", ttl=ttl),))


class Commander:
    """A node of rclpy, a participant of its own, that drives and asks."""

    def __init__(self, robot, name):
        self._robot = robot
        self._drive = robot.publisher(name, flow_topic(TOPIC, name.strip("/")))
        self._ask = robot.publisher(name, lease_topic("base", "request"), STRING)
        self._diagnostics = robot.listener(name, "/diagnostics", DIAGNOSTICS)
        self._answers = robot.listener(name, lease_topic("base", "answer"), STRING)

    def ask_until(self, text, condition, what):
        """Ask again and again: the guard may not know yet whose the name is."""
        message = string_message(Encoding.CDR, text)
        self._robot.say_until(self._ask, message, condition, what)

    def wait_for(self, condition, what):
        self._robot.wait_for(condition, what)

    def drive_until(self, speed, condition, what):
        self._robot.say_until(self._drive, twist(speed), condition, what)

    def set_off(self, speed, is_driven):
        """Stand still, then drive, again and again: a stop of the guard may come between."""

        def noticed():
            self._drive.publish(twist(0.0))
            self._drive.publish(twist(speed))
            return is_driven()

        self._robot.wait_for(noticed, f"{speed} m/s at the driver")

    def is_refused(self, why):
        """Tell whether the guard has dropped all messages of a flow, the last one for a reason."""
        text = rb"passed 0, held 0, dropped [1-9][0-9]*; " + re.escape(why.encode())
        return any(re.search(text, each) for each in self._diagnostics)

    def answers(self):
        return [json.loads(read_string(Encoding.CDR, each, 10_000)) for each in self._answers]


class Scene:
    def __init__(self, ros2, stand, ttl=LONG):
        self.plan = ros2.folder / "rtron.yaml"
        self.plan.write_text(leased_plan(ttl))
        self.driver = ros2.node("twist_subscriber.py", OUT, name="/driver")
        self.guard = ros2.rtron("guard", "--plan", self.plan)
        wait_for(lambda: "guarding 1 topics" in self.guard.log or self.guard.ended, what="it")
        assert not self.guard.ended, self.guard.log
        self._stand = stand

    def commander(self, name):
        return Commander(self._stand(), name)

    def speeds(self):
        return [float(each) for each in re.findall(r"speed (\S+)", self.driver.log)]

    def drives(self, speed):
        """Return a condition: the base is driven at a speed, by a message from now on."""
        known = len(self.speeds())
        return lambda: speed in self.speeds()[known:]

    def rests(self):
        """Tell whether the guard's stop has come: who sets off says 0 before each command, too."""
        return self.speeds()[-5:] == [0.0] * 5

    def logs(self, text):
        return lambda: text in self.guard.log


@pytest.fixture
def scene(ros2, stand):
    return Scene(ros2, stand)


def test_who_has_the_lease_drives_after_a_neutral_command_and_nobody_else(scene):
    nav, teleop = scene.commander(NAV), scene.commander(TELEOP)
    nav.ask_until("acquire a goal", scene.logs("acquire by /nav: base is granted"), "the lease")
    must = "/nav (autonomy) must send a neutral command first"
    nav.drive_until(0.25, lambda: nav.is_refused(must), "the refusal")
    assert 0.25 not in scene.speeds()
    nav.set_off(0.25, scene.drives(0.25))
    holds = "/nav (autonomy) holds base"
    teleop.drive_until(0.375, lambda: teleop.is_refused(holds), "the refusal")
    assert 0.375 not in scene.speeds()
    assert any(each["to"] == NAV and each["granted"] for each in nav.answers())


def test_a_higher_rank_takes_over_and_the_base_stops_until_it_is_neutral(scene):
    nav, teleop = scene.commander(NAV), scene.commander(TELEOP)
    nav.ask_until("acquire", scene.logs("granted to /nav"), "the lease")
    nav.set_off(0.25, scene.drives(0.25))
    why = "taken over from /nav (autonomy): a person is near"
    teleop.ask_until("take_over a person is near", scene.logs(why), "the lease")
    wait_for(scene.rests, what="rest")
    taken = len(scene.speeds())
    nav.ask_until("take_over", scene.logs("/nav (autonomy) has no higher rank"), "the refusal")
    teleop.set_off(0.125, scene.drives(0.125))
    assert 0.25 not in scene.speeds()[taken:]


@pytest.mark.long
def test_a_lease_that_nobody_renews_stops_the_base(ros2, stand):
    scene = Scene(ros2, stand, SHORT)
    nav = scene.commander(NAV)
    nav.ask_until("acquire", scene.logs("granted to /nav"), "the lease")
    nav.drive_until(0.0, scene.drives(0.0), "rest")
    nav.drive_until(0.25, scene.logs("held it last, it was not renewed"), "the end")
    wait_for(scene.rests, what="rest")


@pytest.mark.long
def test_a_stranger_and_who_only_claims_a_name_ask_in_vain(scene):
    nav = scene.commander(NAV)
    nav.ask_until("acquire", scene.logs("granted to /nav"), "the lease")
    nav.wait_for(scene.logs("the audit has looked at the whole graph"), "who came first")
    stranger, impostor = scene.commander(STRANGER), scene.commander(NAV)
    refused = "/stranger may ask for nothing: it is no commander of base"
    stranger.ask_until("acquire", scene.logs(refused), "the refusal")
    claimed = "/nav may ask for nothing: another node owns its name"
    impostor.ask_until("release", scene.logs(claimed), "the refusal")
    assert "released by /nav" not in scene.guard.log
    nav.drive_until(0.0, scene.drives(0.0), "rest")


@pytest.mark.long
def test_who_comes_late_hears_who_holds_it(scene, stand):
    agent = scene.commander(AGENT)
    agent.ask_until("acquire a demo", scene.logs("granted to /agent"), "the lease")
    robot = stand()
    heard = robot.listener("/late", lease_topic("base", "status"), STRING, profile=kept(1))
    robot.wait_for(lambda: heard, "the status")
    status = json.loads(read_string(Encoding.CDR, heard[-1], 10_000))
    assert (status["holder"], status["reason"]) == (AGENT, "acquired: a demo")
