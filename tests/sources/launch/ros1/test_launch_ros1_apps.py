"""The launch files of real apps, against ROS's own loader; no command of them is run."""

import os
from collections import Counter
from pathlib import Path

import pytest
from file_tree import write
from roslaunch_oracle import RosLoader, nodes_of_tree, package, started
from test_launch_ros1_parameters import leaves, our_leaves

from rtron.errors import InputError
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros1 import param_tag
from rtron.sources.launch.ros1.file_search import find_launch_files
from rtron.sources.launch.ros1.reader import read_launch

pytestmark = [
    pytest.mark.ros1,
    pytest.mark.timeout(600),
    pytest.mark.skipif("RTRON_APPS" not in os.environ, reason="RTRON_APPS names no folder of apps"),
]
OUTPUT = "<robot/>"
ENVIRON = {"HOME": "/home/x", "HOSTNAME": "x", "TURTLEBOT3_MODEL": "burger", "AR_CONFIG_PATH": "/x"}


def ours(launch, args, packages, environ):
    try:
        return read_launch(launch.path, args, packages, environ)
    except InputError as error:
        return str(error)


def difference(tree, dump):
    """Return what differs: nothing where both know all and agree."""
    if isinstance(tree, str):
        return tree
    if tree.unresolved:
        return str(tree.unresolved)
    if nodes_of_tree(tree) != started(dump):
        return "nodes"
    return "" if our_leaves(tree) == leaves(dump["server"]) else "parameters"


def test_apps_start_and_set_what_they_do_in_ros(tmp_path, monkeypatch):
    monkeypatch.setattr(param_tag, "_command_output", lambda *_: OUTPUT)
    write(tmp_path, {"xacro/package.xml": package("xacro")})
    found, differences = Counter(), {}
    with RosLoader() as ros:
        for repo in sorted(Path(os.environ["RTRON_APPS"]).glob("*/*")):
            environ = {**ENVIRON, "ROS_PACKAGE_PATH": f"{repo}:{tmp_path}"}
            packages = find_packages([], environ)
            for launch in find_launch_files([repo]):
                args = dict.fromkeys(launch.required, "1")
                request = {"path": str(launch.path), "args": args, "environ": environ}
                dump = ros.ask({**request, "output": OUTPUT})
                found["refused" if "error" in dump else "accepted"] += 1
                if "error" not in dump:
                    differences[str(launch.path)] = difference(
                        ours(launch, args, packages, environ), dump
                    )
    print(found)
    assert found["accepted"] > 0
    assert {path: why for path, why in differences.items() if why} == {}
