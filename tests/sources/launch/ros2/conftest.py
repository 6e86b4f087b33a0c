"""Reads launch files that a test writes, in a workspace with a package `pkg`."""

import pytest

from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.launch.ros2.app import read_app_launch
from rtron.sources.workspace import read_workspace

PYTHON = """
import os
from pathlib import Path
import yaml
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.launch_description_sources import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.descriptions import ComposableNode, ParameterFile, ParameterValue
from launch_ros.event_handlers import OnStateTransition
from launch_ros.substitutions import *
from nav2_common.launch import *
"""


@pytest.fixture
def package(tmp_path):
    """Return the folder of a package in a workspace."""
    folder = tmp_path / "src" / "pkg"
    (folder / "launch").mkdir(parents=True)
    text = "<package format='3'><name>pkg</name><version>1.0.0</version></package>"
    (folder / "package.xml").write_text(text)
    return folder


@pytest.fixture
def read(package):
    """Return a function that reads a launch file of the package: XML, YAML or Python."""

    def app(text, suffix="py", environ=None, **arguments):
        path = package / "launch" / f"app.launch.{suffix}"
        path.write_text(text)
        files = WorkspaceSources(read_workspace([package.parent], {}))
        return read_app_launch(path, arguments, environ or {}, files)

    return app


@pytest.fixture
def python(read):
    """Return a function that reads a Python launch file of some actions."""

    def app(actions, before="", environ=None, **arguments):
        body = f"    return LaunchDescription([{actions}])"
        text = f"{PYTHON}\n{before}\ndef generate_launch_description():\n{body}\n"
        return read(text, environ=environ, **arguments)

    return app


@pytest.fixture
def program(read):
    """Return a function that reads a Python launch file with the text given."""

    def app(text, environ=None, **arguments):
        return read(PYTHON + text, environ=environ, **arguments)

    return app


@pytest.fixture
def xml(read):
    """Return a function that reads an XML launch file of some actions."""

    def app(actions, environ=None, **arguments):
        return read(f"<launch>{actions}</launch>", "xml", environ, **arguments)

    return app
