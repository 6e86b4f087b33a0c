"""A guarded launch whose driver runs in a cell, as roslaunch starts it."""

import json
from pathlib import Path
from textwrap import dedent

import pytest
from celled_base import needs_cell
from driven_base import Driven, drive_plan, write_app
from harness import SOURCE, lives, wait_for

from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import BULK_NODE, GUARD_NODE

pytestmark = [pytest.mark.ros1, needs_cell]
GRAPH = {
    "schema": "rtron.graph/1",
    "app": "base",
    "endpoints": [
        {"node": node, "topic": "/cmd_vel", "direction": direction, "type": "geometry_msgs/Twist"}
        for node, direction in (
            ("/nav", "publish"),
            ("/rogue", "publish"),
            ("/driver", "subscribe"),
        )
    ],
}


DOCS = Path(__file__).parents[3] / "docs" / "cell.md"
USER = "4324"


def instrument(ros1, launch, argument):
    """Write the guarded launch with the driver in a cell; return its file."""
    plan, out = ros1.folder / "rtron.yaml", ros1.folder / "guarded.launch"
    plan.write_text(write_plan(drive_plan()))
    graph = ros1.folder / "graph.json"
    graph.write_text(json.dumps(GRAPH))
    words = (launch, argument, "--plan", plan, "--graph", graph, "-o", out, "--cell", "/driver")
    instrumented = ros1.rtron("instrument", *words)
    wait_for(lambda: instrumented.ended, what="rtron instrument")
    assert "/driver runs in a cell" in instrumented.log
    return out


def test_roslaunch_starts_the_driver_in_its_cell(open_ros1, driver):
    ros1 = open_ros1
    launch = write_app(ros1.folder, driver)
    driven = Driven(ros1.folder / "driven.txt")
    argument = f"out:={driven.path}"
    out = instrument(ros1, launch, argument)
    roslaunch = ros1.spawn("roslaunch", out, argument, PYTHONPATH=str(SOURCE))
    wait_for(driven.navigation, what="navigation at the driver")
    ros1.wait_for_nodes(GUARD_NODE, BULK_NODE)
    words = ("--plan", out.with_suffix(".d") / "rtron.yaml", "--master", ros1.uri)
    verified = ros1.rtron("verify", "--live", *words)
    wait_for(lambda: verified.ended, what="the verification")
    assert verified.code == 0, verified.log
    gateway = ros1.ask(ros1.uri_of("/driver"), "getPid")
    roslaunch.stop()
    wait_for(lambda: not lives(gateway), what="the end of the gateway")


@pytest.mark.long
def test_the_other_nodes_run_as_a_user_by_the_script_of_the_docs(open_ros1, driver):
    ros1 = open_ros1
    home, prefix = ros1.folder / "home", ros1.folder / "as-robot"
    home.mkdir(mode=0o777)
    home.chmod(0o777)
    prefix.write_text(script_of_docs(home))
    prefix.chmod(0o755)
    launch = write_app(ros1.folder, driver)
    nodes = launch.read_text().replace('name="nav"', f'name="nav" launch-prefix="{prefix}"')
    launch.write_text(nodes)
    driven = Driven(ros1.folder / "driven.txt")
    argument = f"out:={driven.path}"
    out = instrument(ros1, launch, argument)
    roslaunch = ros1.spawn("roslaunch", out, argument, PYTHONPATH=str(SOURCE))
    wait_for(driven.navigation, what="navigation at the driver")
    nav = ros1.ask(ros1.uri_of("/nav"), "getPid")
    assert Path(f"/proc/{nav}").stat().st_uid == int(USER)
    roslaunch.stop()


def script_of_docs(home):
    """Return the launch-prefix that docs/cell.md shows, for a user whom every machine has."""
    shown = DOCS.read_text(encoding="utf-8").partition("   #!/bin/sh\n")[2].partition("   ```")[0]
    script = dedent(f"   #!/bin/sh\n{shown}")
    assert "--reuid robot --regid robot --init-groups" in script
    user = f"--reuid {USER} --regid {USER} --clear-groups"
    script = script.replace("--reuid robot --regid robot --init-groups", user)
    return script.replace("/home/robot", str(home))
