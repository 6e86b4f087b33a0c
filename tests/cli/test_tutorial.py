"""The command lines of docs/tutorial.md are run as they stand there, on a small app in its place.

What needs a running robot, or what one measured, is run too: it must end with a clear error about
that, never with one about its arguments.
"""

import json
import re
import shlex
from pathlib import Path

import pytest
import yaml

from rtron.cli.support.service_database import prepare_database
from rtron.service.server.database_setup import open_database

TUTORIAL = (Path(__file__).parents[2] / "docs" / "tutorial.md").read_text()
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```", TUTORIAL, re.MULTILINE | re.DOTALL)
LINES = [line for _, text in BLOCKS for line in text.splitlines() if line.startswith("rtron ")]
LAUNCH, PLAN = (next(text for kind, text in BLOCKS if kind == k) for k in ("python", "yaml"))
SERVE = "serve"
"""It runs until it is stopped, so only its database is made: test_service_commands.py starts it."""
OF_A_ROBOT = ("--live", "--from-run", "upload-graph")
IMAGE = "sensor_msgs/msg/Image"
ROS1_LAUNCH = """<launch>
<node pkg="turtlebot3_navigation" type="drive.py" name="a"/>
<node pkg="turtlebot3_navigation" type="drive.py" name="b"/>
<node pkg="turtlebot3_navigation" type="base.py" name="base"/>
</launch>"""
DRIVE = """#!/usr/bin/env python3
import rospy
from geometry_msgs.msg import Twist
rospy.init_node("x")
rospy.Publisher("cmd_vel", Twist, queue_size=1)
"""
BASE = DRIVE.replace('Publisher("cmd_vel", Twist, queue_size=1)', 'Subscriber("cmd_vel", Twist)')


def graph_of(plan):
    """Return the graph of an app that has the nodes and topics of a plan."""
    guarded = [*plan["grcn"], *plan["rsrcn"]["vflows"], *plan["msrcn"]["aflows"]]
    watched = [*plan["rsrcn"]["iflows"], *plan["msrcn"]["eflows"]]
    camera = plan["fps_monitor"][0]["camera"]
    ends = [
        (flow["publisher"], "publish", topic["topic"], topic["type"])
        for topic in guarded
        for flow in topic["flows"]
    ]
    ends += [(n, "subscribe", t["topic"], t["type"]) for t in guarded for n in t["successors"]]
    ends += [(w["publisher"], "publish", w["topic"], w.get("type", IMAGE)) for w in watched]
    ends += [(camera["publisher"], "publish", camera["topic"], IMAGE)]
    ends += [(watched[0]["publisher"], "subscribe", camera["topic"], IMAGE)]
    keys = ("node", "direction", "topic", "type")
    endpoints = [dict(zip(keys, end, strict=True)) for end in dict.fromkeys(ends)]
    actions = [{"node": "/bt_navigator", "name": plan["grcn"][1]["done"], "role": "server"}]
    graph = {"schema": "rtron.graph/1", "app": "robot", "ros": 2}
    return graph | {"endpoints": endpoints, "actions": actions}


@pytest.fixture
def robot(tmp_path, monkeypatch):
    """Make the folder in which somebody works through the tutorial."""
    monkeypatch.chdir(tmp_path)
    for name in ("HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(tmp_path))
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    (tmp_path / "robot.launch.py").write_text(LAUNCH)
    (tmp_path / "graph.json").write_text(json.dumps(graph_of(yaml.safe_load(PLAN))))
    (tmp_path / "tuned.yaml").write_text(PLAN)
    package = tmp_path / "catkin_ws" / "src" / "turtlebot3_navigation"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>turtlebot3_navigation</name></package>")
    (package / "turtlebot3_navigation.launch").write_text(ROS1_LAUNCH)
    for name, text in (("drive.py", DRIVE), ("base.py", BASE)):
        (package / name).write_text(text)
        (package / name).chmod(0o755)
    return tmp_path


def test_the_lines_of_the_tutorial_run(rtron, robot):
    assert len(LINES) > 15
    for line in LINES:
        words = [word.replace("~", str(robot)) for word in shlex.split(line, comments=True)[1:]]
        if words[0] == SERVE:
            open_database(prepare_database("")).close()
            continue
        if words[0] == "check":
            (robot / "rtron.yaml").write_text(PLAN)
        ran = rtron(*words)
        assert "Usage:" not in ran.err, line
        if any(word in words for word in OF_A_ROBOT):
            assert (ran.code, ran.err[:7]) == (2, "error: "), line
        else:
            assert ran.code in (0, 1), f"{line}\n{ran.err}"
            assert ran.err == "", line
