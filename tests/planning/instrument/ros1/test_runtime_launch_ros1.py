"""An app whose node starts launch files itself, guarded and run by plain roslaunch."""

import hashlib

import pytest
from driven_base import CMD_VEL_GUARD, Driven, drive_plan
from harness import wait_for
from self_launching_app import write_starting_app

from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary.names import SUPERVISOR_NODE

pytestmark = [pytest.mark.ros1, pytest.mark.timeout(180)]
FLOWS = {"/rtron/cmd_vel/flow1": "/nav", "/rtron/cmd_vel/flow2": "/rogue"}


@pytest.fixture
def launch(ros1, driver):
    return write_starting_app(ros1.folder, driver)


def digest(folder):
    return {
        str(path): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def instrument(ros1, launch, out):
    plan = ros1.folder / "rtron.yaml"
    plan.write_text(write_plan(drive_plan()))
    driven = f"out:={ros1.folder / 'driven.txt'}"
    source = ros1.folder / "src"
    process = ros1.rtron(
        "instrument", launch, driven, "--packages", source, "--plan", plan, "-o", out
    )
    wait_for(lambda: process.ended, 60, "rtron instrument")
    assert process.code == 0, process.log
    return driven


def test_the_nodes_of_started_launch_files_go_through_the_guard(ros1, launch):
    before = digest(ros1.folder / "src")
    out = ros1.folder / "guarded" / "start.launch"
    driven = Driven(ros1.folder / "driven.txt")
    argument = instrument(ros1, launch, out)
    ros1.spawn("roslaunch", out, argument)
    ros1.wait_for_nodes("/nav", "/rogue", "/driver", CMD_VEL_GUARD)
    for topic, node in FLOWS.items():
        wait_for(lambda t=topic, n=node: ros1.publishers(t) == {n}, what=f"{node} on {topic}")
    assert ros1.publishers("/cmd_vel") == {CMD_VEL_GUARD, SUPERVISOR_NODE}
    wait_for(lambda: len(driven.navigation()) > 10, what="navigation at the driver")
    blocked = ros1.received(CMD_VEL_GUARD, "/rtron/cmd_vel/flow2") + 500
    wait_for(
        lambda: ros1.received(CMD_VEL_GUARD, "/rtron/cmd_vel/flow2") >= blocked, what="the flood"
    )
    assert driven.turns_after_navigation_began() == 0
    assert digest(ros1.folder / "src") == before


def test_without_the_guard_the_started_attacker_reaches_the_driver(ros1, launch):
    driven = Driven(ros1.folder / "driven.txt")
    ros1.spawn("roslaunch", launch, f"out:={driven.path}")
    wait_for(driven.navigation, what="navigation at the driver")
    wait_for(lambda: driven.turns_after_navigation_began() > 100, what="the attack")
    assert driven.turns_after_navigation_began() > 100


def test_rospack_and_rospkg_find_the_copy_first_and_only_where_it_should_be(ros1, launch):
    out = ros1.folder / "src" / "guarded.launch"
    instrument(ros1, launch, out)
    command = f"{out.with_suffix('.d')}/starter"
    ask = "import rospkg; print(rospkg.RosPack().get_path('start_nav'))"
    copy = str(out.with_suffix(".d") / "overlay" / "start_nav")
    assert ros1.run(command, "/usr/bin/python3", "-c", ask).strip() == copy
    original = str(ros1.folder / "src" / "start_nav")
    assert ros1.run("/usr/bin/python3", "-c", ask).strip() == original
