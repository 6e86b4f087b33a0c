"""Runs guarded launch files of ROS 2 against the double of launch and launch_ros."""

import json
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

DOUBLE = Path(__file__).parents[3] / "ros2" / "launch_double"
HEAD = """\
import launch.events
from launch import Action, LaunchDescription
from launch.actions import *
from launch.conditions import IfCondition, UnlessCondition
from launch.event_handler import EventHandler
from launch.event_handlers import OnProcessExit, OnProcessStart
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import *
from launch_ros.descriptions import ComposableNode

def generate_launch_description():
    return LaunchDescription([{}])
"""
REMAPS = {
    "/teleop": {"/cmd_vel": "/rtron/cmd_vel/teleop"},
    "/base": {"/cmd_vel": "/rtron/cmd_vel/out"},
}


def launch(path, *arguments, double=DOUBLE):
    """Return what `ros2 launch PATH ARGUMENTS` would start."""
    command = [sys.executable, double / "run_launch.py", path, *arguments]
    ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)


def rules(command):
    """Return the remap rules of a command, in order."""
    return [rule for flag, rule in pairwise(command) if flag == "-r" and not rule.startswith("__")]
