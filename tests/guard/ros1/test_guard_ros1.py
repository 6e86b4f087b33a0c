"""The guard between real nodes: what reaches a C++ driver under attack, with it and without."""

from dataclasses import replace

import pytest
from driven_base import (
    CMD_VEL,
    CMD_VEL_GUARD,
    MAP_GUARD,
    PATIENCE,
    Base,
    Driven,
    drive_plan,
    map_plan,
    start_guard,
    write_app,
)
from harness import wait_for

from rtron.planning.plan_file.loader import read_plan
from rtron.planning.plan_file.writer import write_plan
from rtron.sources.live.ros1.source import Ros1LiveSource
from rtron.vocabulary import Mode

pytestmark = pytest.mark.ros1
RATES = pytest.mark.parametrize("rate", [pytest.param(50, marks=pytest.mark.long), 1000])
MANY = 1000


@pytest.fixture
def guarded(ros1, driver):
    return Base(ros1, driver, guarded=True)


@pytest.fixture
def unguarded(ros1, driver):
    return Base(ros1, driver, guarded=False)


def counted(number):
    return list(range(number))


def assert_navigation_is_whole(base):
    """Assert that all of navigation arrived, in order, the first included."""
    base.wait_for_navigation()
    arrived = base.driven.navigation()
    assert arrived == counted(len(arrived))


@RATES
def test_nothing_of_a_flood_arrives_while_navigation_is_active(guarded, rate):
    guarded.navigate()
    guarded.attack(rate)
    guarded.wait_for_blocked(guarded.topic("flow2"), MANY)
    assert_navigation_is_whole(guarded)
    assert guarded.driven.turns() == 0


@RATES
def test_without_the_guard_the_flood_arrives_among_navigation(unguarded, rate):
    unguarded.navigate()
    unguarded.attack(rate)
    wait_for(lambda: unguarded.driven.turns() >= 100, what="the attack")
    navigated = len(unguarded.driven.navigation())
    wait_for(lambda: len(unguarded.driven.navigation()) > navigated, what="navigation")
    assert unguarded.driven.turns() >= 100
    assert len(unguarded.driven.navigation()) > navigated


@pytest.mark.long
def test_nothing_of_a_node_started_by_hand_arrives_active_or_idle(guarded):
    nav = guarded.navigate()
    guarded.attack_by_hand(1000)
    guarded.wait_for_blocked(CMD_VEL, MANY)
    assert_navigation_is_whole(guarded)
    nav.stop()
    active = guarded.ros1.received(CMD_VEL_GUARD, CMD_VEL)
    guarded.wait_for_blocked(CMD_VEL, active + 3 * MANY)
    assert guarded.driven.turns() == 0


def test_nothing_of_a_node_started_by_hand_arrives_before_anybody_has_spoken(guarded):
    guarded.attack_by_hand(1000)
    guarded.wait_for_blocked(CMD_VEL, MANY)
    guarded.navigate()
    assert guarded.driven.turns() == 0


@pytest.mark.long
def test_without_the_guard_a_node_started_by_hand_drives_active_or_idle(unguarded):
    nav = unguarded.navigate()
    unguarded.attack_by_hand(1000)
    wait_for(lambda: unguarded.driven.turns() >= MANY, what="the attack")
    nav.stop()
    idle_from = unguarded.driven.turns()
    wait_for(lambda: unguarded.driven.turns() >= idle_from + MANY, what="the attack when idle")
    assert idle_from >= MANY
    assert unguarded.driven.turns() >= idle_from + MANY


@pytest.mark.long
def test_a_lower_flow_has_the_driver_while_nobody_higher_speaks(guarded):
    guarded.attack(50)
    wait_for(guarded.driven.turns, what="the only flow that speaks")
    nav = guarded.navigate()
    assert guarded.driven.turns_after_navigation_began() == 0
    nav.stop()
    wait_for(guarded.driven.turns_after_navigation_began, what="the lower flow's return")


def test_a_latched_map_reaches_a_late_subscriber(ros1):
    start_guard(ros1, map_plan(), MAP_GUARD)
    ros1.node("map_server.py", "/map_server", "/map:=/rtron/map/flow1")
    wait_for(lambda: ros1.received(MAP_GUARD, "/rtron/map/flow1"), what="the map at the guard")
    for topic in ("/rtron/map/out", "/map"):
        said = ros1.run("rostopic", "echo", "-n", "1", topic)
        assert "width: 3" in said
        assert "data: [0, 100, -1, 0, 100, -1]" in said


@pytest.mark.long
def test_the_tools_of_ros_see_a_coordination_node(guarded):
    ros1 = guarded.ros1
    guarded.navigate()
    assert CMD_VEL_GUARD in ros1.run("rosnode", "list").split()
    info = ros1.run("rosnode", "info", CMD_VEL_GUARD)
    assert " * /rtron/cmd_vel/out [geometry_msgs/Twist]" in info
    assert " * /rtron/cmd_vel/flow1 [geometry_msgs/Twist]" in info
    assert "Pid: " in info
    assert "to: /driver" in info
    assert "xmlrpc reply from" in ros1.run("rosnode", "ping", "-c", "1", CMD_VEL_GUARD)
    assert f" * {CMD_VEL_GUARD} (http://" in ros1.run("rostopic", "info", CMD_VEL)
    assert ros1.run("rostopic", "echo", "-n", "2", CMD_VEL).count("linear:") == 2
    rates = ros1.spawn("rostopic", "hz", CMD_VEL)
    wait_for(lambda: "average rate: " in rates.log, what="rostopic hz")
    sent, received, _ = ros1.ask(ros1.uri_of(CMD_VEL_GUARD), "getBusStats")
    assert {"/rtron/cmd_vel/out", "/cmd_vel"} <= {row[0] for row in sent}
    assert {"/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2", "/cmd_vel"} == {
        row[0] for row in received
    }
    assert ros1.received(CMD_VEL_GUARD, "/rtron/cmd_vel/flow1") > 0
    assert ros1.sent(CMD_VEL_GUARD, "/rtron/cmd_vel/out") > 0


def test_a_scan_of_the_guarded_app_finds_every_end_and_no_ghost(guarded):
    guarded.navigate()
    graph = Ros1LiveSource(guarded.ros1.uri, 15.0).read()
    assert graph.unresolved == ()
    ends = {(e.node, e.topic) for e in graph.endpoints}
    assert {("/nav", "/rtron/cmd_vel/flow1"), ("/driver", "/rtron/cmd_vel/out")} <= ends
    assert (CMD_VEL_GUARD, CMD_VEL) in ends


def test_roslaunch_starts_the_instrumented_app_and_the_attack_fails(ros1, driver):
    launch = write_app(ros1.folder, driver)
    plan = ros1.folder / "rtron.yaml"
    plan.write_text(write_plan(drive_plan()))
    assert_launched_app_is_guarded(ros1, launch, plan)


def test_an_app_whose_driver_has_no_source_is_scanned_planned_and_guarded(ros1, driver):
    """The driver is a program without source, as a vendor's: only the launch file names it."""
    launch, plan = write_app(ros1.folder, driver), ros1.folder / "rtron.yaml"
    app = (launch.parent, "--launch", launch, f"out:={ros1.folder / 'driven.txt'}")
    scanned = ros1.rtron("scan", *app)
    wait_for(lambda: scanned.ended, what="rtron scan")
    assert scanned.code == 1
    assert "/nav and /rogue both drive the robot on /cmd_vel" in scanned.log
    assert "/driver (not read)" in " ".join(scanned.log.split())
    planned = ros1.rtron("plan", *app, "-o", plan)
    wait_for(lambda: planned.ended, what="rtron plan")
    assert planned.code == 0, planned.log
    plan.write_text(write_plan(patient(read_plan(plan))))
    assert_launched_app_is_guarded(ros1, launch, plan)


def patient(plan):
    """Return a plan that also waits for a navigation which a busy machine holds up."""
    (node,) = plan.grcn
    assert (node.mode, node.successors) == (Mode.ENFORCE, ("/driver",))
    assert [flow.publisher for flow in node.flows] == ["/nav", "/rogue"]
    flows = tuple(replace(flow, silent_after=PATIENCE) for flow in node.flows)
    return replace(plan, grcn=(replace(node, flows=flows, release_after=PATIENCE),))


def assert_launched_app_is_guarded(ros1, launch, plan):
    """Instrument and launch an app, and see that nothing of the attack comes between navigation.

    Where a machine stalls, the driver comes over a second after the navigation: then what was first
    is stale, and not for it.
    """
    out = ros1.folder / "guarded" / "base.launch"
    driven = Driven(ros1.folder / "driven.txt")
    argument = f"out:={driven.path}"
    instrumented = ros1.rtron("instrument", launch, argument, "--plan", plan, "-o", out)
    wait_for(lambda: instrumented.ended, what="rtron instrument")
    assert instrumented.code == 0, instrumented.log

    ros1.spawn("roslaunch", out, argument)
    wait_for(driven.navigation, what="navigation at the driver")
    flow = "/rtron/cmd_vel/flow2"
    before = ros1.received(CMD_VEL_GUARD, flow)
    wait_for(lambda: ros1.received(CMD_VEL_GUARD, flow) >= before + MANY, what="the attack")
    arrived = driven.navigation()
    assert arrived == [arrived[0] + number for number in counted(len(arrived))]
    assert len(arrived) > 1
    assert driven.turns_after_navigation_began() == 0
