"""The launch file that `rtron instrument --keystore` writes, run by launch_ros under Enforce."""

import os
import sys
from pathlib import Path

import pytest
from cyclone_rmw import needs_security
from harness import wait_for
from ros2_harness import NODES2

pytest.importorskip("rclpy", reason="needs ROS 2")
pytest.importorskip("ament_index_python", reason="needs ROS 2")
pytest.importorskip("launch_ros.actions", reason="needs launch and launch_ros, not in the wheels")
from secured_app import EVIL, OUT, SPEED, SecuredApp, speeds, wait_for_commands

pytestmark = [pytest.mark.ros2, needs_security]
MANIFEST = """<package format="3">
  <name>pkg</name><version>1.0.0</version><description>An app</description>
  <maintainer email="app@example.org">App</maintainer><license>Apache-2.0</license>
</package>
"""
LAUNCH = """from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    names = ("driver", "nav")
    return LaunchDescription(
        [Node(package="pkg", executable=name, name=name, output="screen") for name in names]
    )
"""
RUN = """import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

service = LaunchService()
included = IncludeLaunchDescription(PythonLaunchDescriptionSource(sys.argv[1]))
service.include_launch_description(LaunchDescription([included]))
sys.exit(service.run())
"""
PROGRAMS = {
    "driver": "twist_subscriber.py /cmd_vel",
    "nav": f"twist_publisher.py /cmd_vel {SPEED} 50",
}


def install_package(folder):
    """Install a package of two programs and its launch file; return the launch file."""
    index = folder / "share/ament_index/resource_index/packages"
    programs, share = folder / "lib/pkg", folder / "share/pkg"
    for each in (index, programs, share):
        each.mkdir(parents=True)
    (index / "pkg").touch()
    (share / "package.xml").write_text(MANIFEST)
    for name, words in PROGRAMS.items():
        program = programs / name
        program.write_text(f'#!/bin/sh\nexec {sys.executable} {NODES2}/{words} "$@"\n')
        program.chmod(0o755)
    launch = share / "app.launch.py"
    launch.write_text(LAUNCH)
    return launch


def test_a_guarded_launch_under_enforce_drives_the_base_and_an_intruder_does_not(ros2):
    app = SecuredApp(ros2)
    launch, guarded = install_package(ros2.folder / "ws"), ros2.folder / "guarded.launch.py"
    files = ("--plan", app.plan, "--graph", app.graph, "--keystore", app.keystore)
    written = ros2.rtron("instrument", launch, "--packages", launch.parent, *files, "-o", guarded)
    wait_for(lambda: written.ended, 60, "the guarded launch")
    assert written.code == 0, written.log
    prefixes = f"{ros2.folder / 'ws'}{os.pathsep}{os.environ.get('AMENT_PREFIX_PATH', '')}"
    run = ros2.folder / "run.py"
    run.write_text(RUN)
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    launched = ros2.spawn(sys.executable, run, guarded, AMENT_PREFIX_PATH=prefixes, PATH=path)
    wait_for(lambda: "guarding 1 topics" in launched.log, 60, "the guard")
    wait_for_commands(launched)
    ros2.node("twist_publisher.py", OUT, EVIL, "200", "400", name="/stranger")
    wait_for_commands(launched, 200)
    assert speeds(launched)[EVIL] == 0
    assert "RTron:" not in launched.log
