"""The demo's ROS 1 app, as RTron reads it without running it."""

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from rtron.demos import apps

APPS = Path(next(iter(apps.__path__)))
FOLDERS = [APPS / "ros1", APPS / "third_party" / "ros1"]
SCRIPTS = [path for folder in FOLDERS for path in sorted(folder.glob("*/scripts/*"))]
ENDPOINTS = {
    ("/turtlebot3_core", "subscribe", "/cmd_vel"),
    ("/turtlebot3_core", "publish", "/odom"),
    ("/turtlebot3_core", "publish", "/tf"),
    ("/lds", "publish", "/scan"),
    ("/camera", "publish", "/camera/image"),
    ("/battery", "publish", "/battery_state"),
    ("/mission", "subscribe", "/odom"),
    ("/mission", "publish", "/move_base_simple/goal"),
    ("/move_base", "subscribe", "/odom"),
    ("/move_base", "subscribe", "/move_base_simple/goal"),
    ("/move_base", "subscribe", "/control/max_vel"),
    ("/move_base", "subscribe", "/detect/objects"),
    ("/move_base", "publish", "/cmd_vel"),
    ("/recogniser", "subscribe", "/camera/image"),
    ("/recogniser", "publish", "/detect/objects"),
    ("/max_velocity", "subscribe", "/detect/objects"),
    ("/max_velocity", "publish", "/control/max_vel"),
    ("/teleop", "publish", "/teleop/cmd_vel"),
    ("/speaker", "subscribe", "/detect/objects"),
    ("/speaker", "publish", "/audio"),
    ("/tb3_safe_control", "subscribe", "/teleop/cmd_vel"),
    ("/tb3_safe_control", "subscribe", "/scan"),
    ("/tb3_safe_control", "publish", "/cmd_vel"),
    ("/tb3_monitor", "subscribe", "/odom"),
    ("/tb3_monitor", "subscribe", "/battery_state"),
    ("/tb3_monitor", "publish", "/monitor/state"),
    ("/tb3_monitor", "publish", "/control/max_vel"),
    ("/tb3_monitor", "publish", "/move_base_simple/goal"),
}
RISKS = {
    "GR-ST:/cmd_vel",
    "GR-ST:/control/max_vel",
    "GR-ST:/move_base_simple/goal",
    "RSR-max_vel:/control/max_vel",
    "RSR-image:/recogniser",
    "MSR-action:/cmd_vel",
    "MSR-action:/move_base_simple/goal",
    "MSR-action:/teleop/cmd_vel",
    "MSR-event:/battery_state",
    "MSR-event:/detect/objects",
    "MSR-event:/odom",
}


def scanned(form):
    command = [sys.executable, "-m", "rtron", "scan", *FOLDERS, "--fail-on", "never"]
    launch = ["--launch", "tb3_demo/tb3_demo.launch", "--format", form]
    done = subprocess.run([*command, *launch], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_each_node_is_a_program_of_debians_python(script):
    text = script.read_text()
    ast.parse(text, feature_version=(3, 10))
    assert text.startswith("#!/usr/bin/python3\n")
    assert os.access(script, os.X_OK)
    assert len(text.splitlines()) <= 60


def test_every_endpoint_stands_in_the_source_as_it_is():
    graph = scanned("graph")
    found = {(e["node"], e["direction"], e["topic"]) for e in graph["endpoints"]}
    assert found == ENDPOINTS
    assert {e.get("resolution", "literal") for e in graph["endpoints"]} == {"literal"}
    assert not graph.get("unresolved")


def test_the_risks_are_those_of_the_paper():
    found = {risk["id"]: risk for risk in scanned("json")["risks"]}
    assert set(found) == RISKS
    contend = found["GR-ST:/cmd_vel"]["role_nodes"].values()
    assert {node for nodes in contend for node in nodes} == {"/move_base", "/tb3_safe_control"}
