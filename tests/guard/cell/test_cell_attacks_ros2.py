"""Attacks that work on an unprotected base of ROS 2: in a cell nothing arrives or stops."""

import sys
from contextlib import closing

import pytest
from celled_base import needs_cell, needs_open_packages
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from celled_base2 import CMD_VEL, FLOW1, NODE, OUT, CelledBase2, alone, ros2_in_open_folder
from rmw_marks import needs_fast_dds
from ros2_harness import NODES2

from rtron.guard.audit.ros2.celled_graph import CellReader
from rtron.guard.cell.access import CellAccess
from rtron.wire.ros2.domain_id import domain_address

pytestmark = [pytest.mark.ros2, needs_cell, needs_open_packages]
GUARD = "/rtron/grcn_cmd_vel"


@pytest.fixture(scope="module")
def moving_base2():
    """A base that navigation drives, for attacks that must leave it as they find it."""
    with ros2_in_open_folder() as ros2:
        base = CelledBase2(ros2)
        base.navigate()
        base.wait_for_more()
        yield base


@pytest.mark.parametrize(
    ("topic", "name"),
    [
        (CMD_VEL, "/intruder"),
        (OUT, "/intruder"),
        (OUT, "/nav"),
        (OUT, GUARD),
        (OUT, NODE),
        (FLOW1, "/nav"),
    ],
)
def test_an_intruder_is_not_heard(moving_base2, topic, name):
    """Long, the first of them: the cell, the guard and the base start."""
    base, since = moving_base2, len(moving_base2.messages())
    intruder = base.intrude(topic, name)
    base.assert_undisturbed(since, more=100)
    intruder.kill()  # without a goodbye
    base.assert_undisturbed(since)


def test_an_intruder_beside_the_cell_is_not_heard_by_shared_memory(moving_base2):
    """Fast DDS takes networks that have nothing but `lo` for one host."""
    base, since = moving_base2, len(moving_base2.messages())
    intruder = base.intrude_beside(OUT)
    base.assert_undisturbed(since, more=100)
    intruder.kill()
    base.assert_undisturbed(since)


def writer_inside(base):
    """Return the GUID with which the guard's carrier writes what the base reads."""
    reader = CellReader(CellAccess(domain_address(base.ros2.domain), NODE))
    with closing(reader):
        found = [each.gid for each in reader.endpoints([OUT]) if each.node == GUARD]
    assert len(found) == 1
    return found[0].hex()


def forge(base, guid, where):
    """Send 2000 messages in the name of a writer; `where` gives a command that runs there."""
    script = (sys.executable, NODES2 / "rtps_forger.py", base.ros2.domain, guid, "9", "2000")
    return base.ros2.spawn(*where(*script))


@pytest.mark.long
@needs_fast_dds("the packets are those of Fast DDS")
def test_packets_in_the_name_of_the_guards_writer_are_heard_inside_alone():
    """Outside the cell's network they reach nobody; that they are good shows who is inside."""
    with ros2_in_open_folder() as ros2:
        base = CelledBase2(ros2)
        base.navigate()
        base.wait_for_more()
        guid, since = writer_inside(base), len(base.messages())
        for where in (lambda *command: command, alone):
            forger = forge(base, guid, where)
            wait_for(lambda forger=forger: "said all" in forger.log, what="the forger's end")
            base.assert_undisturbed(since, more=100)
        forge(base, guid, base.inside)
        wait_for(lambda: any(x == "9.0" for x, _ in base.messages()), what="the forger inside")
