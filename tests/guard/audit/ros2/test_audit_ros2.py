"""`rtron verify --live` and the guard's audit on a real ROS 2: closed, disturbed, and restarted."""

import os
import signal

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from guarded_base2 import CMD_VEL, FLOW1, GRCN, OUT, GuardedBase2
from rmw_marks import needs_fast_dds
from ros2_harness import LASTING

from rtron.guard.transport.ros2.participants import ParticipantLiveness, ParticipantState
from rtron.guard.transport.ros2.process_table import ProcessTable
from rtron.vocabulary import GUARD_NODE
from rtron.wire.ros2.endpoints import publishers_of
from rtron.wire.ros2.session import Ros2Session

pytestmark = pytest.mark.ros2


@pytest.fixture
def base(ros2):
    return GuardedBase2(ros2)


def states(report):
    return {path["node"]: path["state"] for path in report["paths"]}


def test_verify_and_the_audit_tell_what_comes_and_goes(base):
    """Long: `rtron verify` twice waits until the domain is quiet for 3.5 s."""
    base.start()
    found = base.verified(0)
    assert (found["verdict"], found["problems"]) == ("closed", [])
    assert states(found) == {"/driver": "closed", "/nav": "closed"}
    unguarded = {each["what"] for each in found["unguarded"]}
    assert {"/driver/set_parameters", "/nav/set_parameters"} <= unguarded
    assert not any("get_" in what for what in unguarded)

    intruders = [
        base.speaker("/rogue", OUT, "7.0"),
        base.speaker("/other", FLOW1, "8.0"),
        base.speaker(GRCN, CMD_VEL, "9.0"),
        base.speaker("/nav", FLOW1, "10.0"),
    ]
    for kind in (": foreign publisher: /rogue", ": foreign publisher: /other"):
        wait_for(lambda kind=kind: base.alarms(kind), what=kind)
    wait_for(lambda: base.alarms(f"has taken the name {GRCN}"), what="the impostor of the guard")
    wait_for(lambda: base.alarms("2 participants have the name /nav"), what="that of the flow")
    found = base.verified(1)
    foreign = {path["node"]: path["foreign"] for path in found["paths"]}
    assert foreign["/driver"] == ["/rogue"]
    assert foreign["/nav"] == ["/other"]
    assert any(f"has the name of the guard's node {GRCN}" in each for each in found["problems"])
    assert [base.speeds(speed) for speed in ("8.0", "9.0", "10.0")] == [0, 0, 0]

    for intruder in intruders:
        intruder.stop()
    wait_for(lambda: len(base.alarms("no more:")) >= len(intruders), what="the end of the alarms")


@pytest.mark.long
def test_what_does_not_run_is_not_closed(base):
    base.start_guard()
    wait_for(lambda: "guarding 1 topics" in base.guard.log, what="the guard")
    found = base.verified(2)
    assert (found["verdict"], found["problems"]) == ("unknown", [])
    assert found["not_seen"] == ["/driver", "/nav"]


@pytest.mark.long
def test_a_publisher_that_was_killed_and_started_anew_is_no_impostor(base):
    base.start()
    base.nav.tell(signal.SIGKILL)
    wait_for(lambda: base.nav.ended, what="the end of navigation")
    heard = base.speeds("0.5")
    base.start_nav()
    wait_for(lambda: base.speeds("0.5") > heard + 5, what="navigation anew")
    assert [line for line in base.alarms() if ": guard:" not in line] == []


@pytest.mark.long
def test_a_stranger_brakes_where_the_plan_says_so(ros2):
    base = GuardedBase2(ros2, "stop")
    base.start()
    rogue = base.speaker("/rogue", OUT, "7.0")
    wait_for(lambda: base.speeds("0.0") > 3, what="the stop")
    refused = base.clear()
    assert refused.code == 2
    assert "/cmd_vel stays stopped: " in refused.log
    rogue.stop()
    wait_for(lambda: base.alarms("no more:"), what="the end of the alarm")
    passed, stops = base.speeds("0.5"), base.speeds("0.0")
    wait_for(lambda: base.speeds("0.0") > stops + 20, what="the stop that goes on")
    assert base.speeds("0.5") == passed
    wait_for(base.is_cleared, what="the guard's leave to drive again")
    wait_for(lambda: base.speeds("0.5") > passed + 5, what="navigation again")


# Unanswered, there would be 0.4 stops for each message of the first and 0.1 of the second.
@pytest.mark.parametrize(
    ("name", "rate", "share"), [("/rogue", "50", 0.9), (GUARD_NODE, "200", 0.5)]
)
def test_each_message_of_a_stranger_is_answered(ros2, name, rate, share):
    base = GuardedBase2(ros2, "stop")
    base.start()
    base.speaker(name, OUT, "7.0", rate)
    wait_for(lambda: base.alarms("alarm: intrusion"), what="the alarm")
    wait_for(lambda: base.speeds("0.0") > 20, what="the end of the braking")
    before = len(base.heard())
    wait_for(lambda: base.heard()[before:].count("7.0") > 200, what="the stranger's messages")
    heard = base.heard()[before:]
    assert heard.count("0.0") / heard.count("7.0") > share


@pytest.mark.long
def test_a_stranger_that_died_without_a_word_holds_the_robot_no_longer_than_a_person_does(ros2):
    base = GuardedBase2(ros2, "stop")
    base.start()
    rogue = base.speaker("/rogue", OUT, "7.0", **LASTING)
    wait_for(lambda: base.alarms("alarm: intrusion"), what="the alarm")
    rogue.kill()
    wait_for(base.is_cleared, what="the guard's leave to drive again")
    passed = base.speeds("0.5")
    wait_for(lambda: base.speeds("0.5") > passed + 5, what="navigation again")
    stops = base.speeds("0.0")
    base.speaker("/rogue", OUT, "7.0")
    wait_for(lambda: len(base.alarms("alarm: intrusion")) > 1, what="the next alarm")
    wait_for(lambda: base.speeds("0.0") > stops + 5, what="the next stop")


def kill_guard(base):
    """Kill the guard; return how many intrusions its supervisor had told of."""
    told = len(base.alarms("alarm: intrusion"))
    os.kill(base.guard_process(), signal.SIGKILL)
    return told


def kill_guard_and_supervisor(base):
    """Kill those that would start each other again, and begin anew: with nothing told yet."""
    for number in (signal.SIGSTOP, signal.SIGKILL):
        os.kill(base.guard_process(), number)
        os.kill(base.guard.pid, number)
    wait_for(lambda: base.guard.ended, what="the end of the supervisor")
    base.start_guard()
    return 0


@pytest.mark.long
@pytest.mark.parametrize("kill", [kill_guard, kill_guard_and_supervisor])
def test_an_intrusion_outlives_the_guard(ros2, kill):
    base = GuardedBase2(ros2, "stop")
    base.start()
    rogue = base.speaker("/rogue", OUT, "7.0")
    wait_for(lambda: base.alarms("alarm: intrusion"), what="the alarm")
    rogue.stop()
    wait_for(lambda: base.alarms("no more:"), what="the end of the alarm")
    passed = base.speeds("0.5")
    told = kill(base)
    wait_for(lambda: len(base.alarms("alarm: intrusion")) > told, what="the next guard's alarm")
    stops = base.speeds("0.0")
    wait_for(lambda: base.speeds("0.0") > stops + 100, what="the next guard's stop")
    assert base.speeds("0.5") == passed
    wait_for(base.is_cleared, what="the next guard's leave to drive again")
    wait_for(lambda: base.speeds("0.5") > passed + 5, what="navigation again")


@needs_fast_dds("the GIDs of Cyclone DDS hold no process ids")
def test_a_killed_process_is_known_to_be_gone_while_the_domain_still_lists_it(ros2):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        session = Ros2Session(ros2.domain)
    looker = session.node("/looker")
    processes = ProcessTable()
    lives = ParticipantLiveness(session.participant("/looker"), processes)
    node = ros2.node("twist_publisher.py", FLOW1, "1.0", "10", name="/nav")
    wait_for(lambda: publishers_of(looker, FLOW1), what="the node")
    (found,) = publishers_of(looker, FLOW1)
    lives.update([found.participant, session.participant("/looker")], 0)
    assert lives.process(found.participant) == processes.process(node.pid)
    assert lives.state(found.participant) is ParticipantState.RUNNING
    assert lives.process(session.participant("/looker")) == processes.process(os.getpid())
    node.tell(signal.SIGKILL)
    wait_for(
        lambda: lives.state(found.participant) is ParticipantState.ENDED, what="the end of the node"
    )
    assert publishers_of(looker, FLOW1)
    session.close()


@pytest.mark.long
def test_an_empty_domain_cannot_be_told(base):
    assert "nobody is in the ROS 2 domain" in base.verified(2, "1")
