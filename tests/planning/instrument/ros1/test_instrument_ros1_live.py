"""A guarded launch, really launched: plain roslaunch, a real master, nodes of rospy."""

import os
import signal
import socket
import subprocess
from contextlib import contextmanager
from xmlrpc.client import ServerProxy

import pytest
from file_tree import write
from harness import lives, wait_for
from plans import grcn, plan_of
from roslaunch_oracle import package

from rtron.planning.instrument import instrument_ros1, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros1.reader import read_launch

LIMIT = 30  # seconds
NODE = """#!/usr/bin/python3
import rospy, sys
from std_msgs.msg import String
rospy.init_node("anything")
sides = [
    rospy.Subscriber(name[1:], String, print) if name[0] == "<" else
    rospy.Publisher(name[1:], String, queue_size=1)
    for name in rospy.myargv()[1:]
]
rospy.spin()
"""
APP = {
    "app/package.xml": package("app"),
    "app/node": NODE,
    "app.launch": """<launch>
  <remap from="speed" to="/cmd_vel"/>
  <node pkg="app" type="node" name="teleop" args="&gt;cmd_vel"/>
  <include file="$(find app)/nav.launch" ns="nav"/>
  <node pkg="app" type="node" name="base" args="'&lt;cmd_vel'"/>
  <node pkg="app" type="node" name="both" args="'&lt;cmd_vel' '&gt;/cmd_vel'"/>
  <node pkg="app" type="node" name="stranger" args="'&gt;cmd_vel'"/>
</launch>""",
    "app/nav.launch": """<launch>
  <node pkg="app" type="node" name="$(anon planner)" args="'&gt;speed' '&gt;~private'">
    <remap from="~private" to="/cmd_vel"/>
  </node>
</launch>""",
}
PLAN = plan_of(grcn("/cmd_vel", ["/teleop", "/nav/planner_*", "/both"], ["/base", "/both"]))


@contextmanager
def running(command, environ, log):
    """Run a command until the end of the block, then interrupt it as ^C does."""
    with log.open("wb") as output:
        process = subprocess.Popen(command, env=environ, stdout=output, stderr=output)
    try:
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(timeout=LIMIT)
        finally:
            process.kill()
            process.wait()


@pytest.fixture
def environ(tmp_path):
    """Return the environment of a master of our own."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    return os.environ | {
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(tmp_path / "home"),
        "ROS_LOG_DIR": str(tmp_path / "log"),
        "ROS_PACKAGE_PATH": str(tmp_path),
        "PYTHONPATH": "",
    }


@pytest.fixture
def master(environ, tmp_path):
    """Run a master; return its API."""
    uri = environ["ROS_MASTER_URI"]
    command = ["rosmaster", "--core", "-p", uri.rpartition(":")[2]]
    with running(command, environ, tmp_path / "master.log"), ServerProxy(uri) as proxy:
        wait_for(lambda: answers(proxy))
        yield proxy


def answers(proxy):
    try:
        return proxy.getPid("/test")[0] == 1
    except OSError:
        return False


def ends(proxy):
    """Return who publishes and who subscribes each topic; anonymous names as patterns."""
    publishers, subscribers, _ = proxy.getSystemState("/test")[2]
    return [
        {topic: {anonymised(node) for node in nodes} for topic, nodes in side}
        for side in (publishers, subscribers)
    ]


def anonymised(node):
    return "/nav/planner_*" if node.startswith("/nav/planner_") else node


@pytest.mark.ros1
def test_plain_roslaunch_starts_the_guarded_app_and_the_guard(master, environ, tmp_path):
    write(tmp_path, APP)
    (tmp_path / "app" / "node").chmod(0o755)
    tree = read_launch(tmp_path / "app.launch", {}, find_packages([tmp_path]), {})
    out, started = tmp_path / "guarded" / "app.launch", tmp_path / "started"
    command = ("sh", "-c", f"echo $$ $2 > {started}; exec sleep 1000", "guard")
    write_guarded_launch(instrument_ros1(tree, PLAN, out, GuardFiles("", command=command)))

    publish = {
        "/rtron/cmd_vel/flow1": {"/teleop"},
        "/rtron/cmd_vel/flow2": {"/nav/planner_*"},
        "/rtron/cmd_vel/flow3": {"/both"},
        "/cmd_vel": {"/stranger"},
    }
    subscribe = {"/rtron/cmd_vel/out": {"/base"}, "/rtron/cmd_vel/flow3": {"/both"}}

    def closed():
        found = ends(master)
        return publish.items() <= found[0].items() and subscribe.items() <= found[1].items()

    with running(["roslaunch", out], environ, tmp_path / "roslaunch.log"):
        wait_for(lambda: started.exists() and started.read_text().split())
        process, plan = started.read_text().split()
        wait_for(closed)
        assert "/cmd_vel" not in ends(master)[1]
        assert plan == str(out.parent / "app.d" / "rtron.yaml")
        assert lives(process)
    wait_for(lambda: not lives(process))
