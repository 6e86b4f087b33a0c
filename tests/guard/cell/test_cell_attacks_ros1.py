"""Attacks that work on an unprotected base: in a cell nothing arrives, and nothing stops."""

import subprocess

import pytest
from celled_base import FLOW1, NODE, OUT, CelledBase, celled_plan, needs_cell
from driven_base import CMD_VEL, CMD_VEL_GUARD
from harness import wait_for
from proxied_master import start
from raw_ros1 import LIMIT_S, RawPublisher, twist

from rtron.wire.ros1.xmlrpc import ros_call

pytestmark = [pytest.mark.ros1, needs_cell]


@pytest.mark.parametrize("topic", [OUT, FLOW1, CMD_VEL])
@pytest.mark.parametrize("rate", ["200", "25"])
def test_an_intruder_is_not_heard(moving_base, topic, rate):
    base, since = moving_base, len(moving_base.driven.messages())
    intruder = base.ros1.node("rogue.py", "/intruder", rate, f"{CMD_VEL}:={topic}")
    wait_for(lambda: "/intruder" in base.ros1.publishers(topic), what="the intruder")
    base.assert_undisturbed(since)
    intruder.kill()  # without a goodbye
    base.assert_undisturbed(since)


def test_a_ghost_calls_the_driver_and_the_guard_and_is_not_heard(moving_base):
    base, since = moving_base, len(moving_base.driven.messages())
    with RawPublisher(base.ros1.uri, "/ghost", "/elsewhere") as ghost:
        for node, topic in ((NODE, OUT), (NODE, CMD_VEL), (CMD_VEL_GUARD, FLOW1)):
            uri = base.ros1.uri_of(node)
            ros_call(uri, "publisherUpdate", "/master", topic, [ghost.uri], timeout=LIMIT_S)
        for _ in range(20):
            ghost.send(twist(9))
        base.assert_undisturbed(since)
        assert not ghost.connections


def test_a_ghost_that_registers_without_a_client_library_is_not_heard(moving_base):
    base, since = moving_base, len(moving_base.driven.messages())
    with RawPublisher(base.ros1.uri, "/ghost", OUT) as ghost:
        base.wait_for_more()
        assert not ghost.connections
    base.assert_undisturbed(since)


def test_bursts_of_short_lived_publishers_are_not_heard(moving_base):
    base, since = moving_base, len(moving_base.driven.messages())
    for number in range(10):
        with RawPublisher(base.ros1.uri, f"/burst{number}", OUT) as burst:
            assert not burst.connections
    base.assert_undisturbed(since)


def test_the_driver_is_not_shut_down_by_others(moving_base):
    base, since = moving_base, len(moving_base.driven.messages())
    base.ros1.run("rosnode", "kill", NODE)
    wait_for(lambda: f"a shutdown of {NODE} is refused" in base.cell.log, what="the refusal")
    base.assert_undisturbed(since)
    assert not base.cell.ended


def test_who_takes_the_drivers_name_gets_nothing(moving_base):
    base, since = moving_base, len(moving_base.driven.messages())
    impostor = base.ros1.node("rogue.py", NODE, "200", f"{CMD_VEL}:={OUT}")
    base.assert_undisturbed(since)
    impostor.kill()
    base.assert_undisturbed(since)


def test_another_user_cannot_enter(moving_base):
    (first,) = cell_processes(moving_base)
    for word in ("--net", "--mount"):
        command = ["setpriv", "--reuid=4711", "--regid=4711", "--clear-groups"]
        enter = ["nsenter", "-t", str(first), word, "true"]
        ended = subprocess.run([*command, *enter], capture_output=True, text=True, check=False)
        assert ended.returncode != 0
        assert "Permission denied" in ended.stderr or "not permitted" in ended.stderr


def cell_processes(base):
    """Return the first process of the cell: the child of the one that the gateway has started."""
    children = subprocess.run(
        ["pgrep", "-P", str(base.cell.pid)], capture_output=True, text=True, check=True
    ).stdout.split()
    (unshare,) = children
    found = subprocess.run(["pgrep", "-P", unshare], capture_output=True, text=True, check=True)
    return [int(pid) for pid in found.stdout.split()]


@pytest.mark.long
def test_behind_the_master_proxy_who_takes_a_planned_name_gets_nothing(open_ros1, driver):
    base = CelledBase(start(open_ros1, celled_plan()), driver)
    base.navigate()
    for name in ("/nav", NODE):
        impostor = base.ros1.node("rogue.py", name, "200", f"{CMD_VEL}:={FLOW1}")
        wait_for(lambda name=name: f"to '{name}'" in base.ros1.master.log, what="the refusal")
        base.assert_undisturbed()
        impostor.kill()


def test_navigation_runs_under_the_name_of_the_plan(moving_base):
    assert moving_base.ros1.connected("/nav", CMD_VEL_GUARD, FLOW1)
    assert not moving_base.ros1.subscribers(OUT)
