"""The latched stop between nodes of ROS 1: over restarts, until all sources are released."""

import os
import signal

import pytest
from commanded_base import CommandedBase
from driven_base import CMD_VEL_GUARD, start_guard
from harness import lives, wait_for
from plans import grcn, plan_of

from rtron.vocabulary import (
    GUARD_NODE,
    SECOND,
    SUPERVISOR_NODE,
    Flow,
    PolicyName,
    StopButton,
    StopSources,
)

pytestmark = pytest.mark.ros1
NAV = "/nav"
BUTTON = StopButton(name="red", topic="/estop", publisher="/estop_driver")


def stoppable_plan(*buttons):
    flows = (Flow(name="nav", publisher=NAV, silent_after=3 * SECOND),)
    base = grcn("/cmd_vel", (), ["/driver"], flows=flows, policy=PolicyName.BLOCK)
    return plan_of(base, app="stopped", stop_sources=StopSources(buttons=buttons))


@pytest.fixture
def base(ros1):
    return CommandedBase(ros1, stoppable_plan())


def driving(base):
    nav = base.commander(NAV)
    nav.drive(0.25)
    base.wait_for_speed(0.25)
    return nav


def wait_for_rest(base):
    wait_for(lambda: base.speeds()[-1] == 0.0, what="rest")
    return len(base.speeds())


def received(base):
    return base.ros1.received(CMD_VEL_GUARD, "/rtron/cmd_vel/nav")


def assert_stopped(base):
    """Assert that none of many commands that reach the guard reaches the driver."""
    known, before = len(base.speeds()), received(base)
    wait_for(lambda: received(base) > before + 50, what="commands at the guard")
    assert set(base.speeds()[known:]) <= {0.0}


def end_guard(base):
    """Kill guard and supervisor at once, as a crash of the machine does."""
    ros1 = base.ros1
    pids = [ros1.ask(ros1.uri_of(node), "getPid") for node in (SUPERVISOR_NODE, GUARD_NODE)]
    os.killpg(base.guard.pid, signal.SIGKILL)
    wait_for(lambda: not any(map(lives, pids)), what="the end of guard and supervisor")


def test_a_stop_of_a_person_outlives_guard_and_supervisor(base):
    nav = driving(base)
    assert base.rtron("stop", "--reason", "a person on the track").startswith("stopped by ")
    wait_for_rest(base)
    guard = base.ros1.ask(base.ros1.uri_of(GUARD_NODE), "getPid")
    os.kill(guard, signal.SIGKILL)
    wait_for(lambda: base.guard.log.count("still stopped, nobody has released it") == 1)
    wait_for(lambda: base.ros1.connected(NAV, CMD_VEL_GUARD, "/rtron/cmd_vel/nav"), what="nav")
    assert_stopped(base)
    end_guard(base)
    base.guard = start_guard(base.ros1, base.plan, CMD_VEL_GUARD)
    base.wait_for_log("still stopped, nobody has released it: robot by ")
    assert_stopped(base)
    refused = base.rtron("release", "robot", "--reason", "the track is free")
    assert "/nav is not neutral" in refused
    listed = base.rtron("release")
    assert "a person on the track" in listed
    nav.drive_neutral()
    released = base.rtron("release", "robot", "--reason", "the track is free")
    assert released.startswith("the stop of robot is released by ")
    nav.drive(0.25)
    base.wait_for_speed(0.25)
    assert base.rtron("release") == "nothing has stopped the robot\n"


def test_a_button_stops_until_it_is_free_and_released(ros1):
    base = CommandedBase(ros1, stoppable_plan(BUTTON))
    nav = base.commander(NAV)
    nav.drive(0.25)
    wait_for(lambda: received(base) > 50, what="commands at the guard")
    assert set(base.speeds()) <= {0.0}
    pressed = ros1.folder / "pressed"
    ros1.node("stop_button.py", "/estop_driver", pressed)
    base.wait_for_speed(0.25)
    pressed.touch()
    base.wait_for_log("stopped by red: /estop_driver, pressed")
    wait_for_rest(base)
    nav.drive_neutral()
    assert "is still there: pressed" in base.rtron("release", "red", "--reason", "test")
    pressed.unlink()
    released = "the stop of red is released"
    wait_for(lambda: released in base.rtron("release", "red", "--reason", "test"), what="it")
    nav.drive(0.25)
    base.wait_for_speed(0.25)


@pytest.mark.long
def test_a_stranger_presses_no_button_and_one_that_is_gone_stops(ros1):
    base = CommandedBase(ros1, stoppable_plan(BUTTON))
    nothing = ros1.folder / "nothing"
    button = ros1.node("stop_button.py", "/estop_driver", nothing)
    driving(base)
    ros1.node("stop_button.py", "/stranger", ros1.folder)
    base.wait_for_log("/stranger is ignored: it is not /estop_driver")
    base.wait_for_speed(0.25)
    button.kill()
    wait_for_rest(base)
    assert_stopped(base)
    ros1.node("stop_button.py", "/estop_driver", nothing)
    base.wait_for_speed(0.25)
