"""RTron as an ament_python package, as far as that can be seen without colcon."""

import argparse
import configparser
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from small_app import LAUNCH_FILE, write_app

from rtron import __version__
from rtron.cli import main
from rtron.cli.ros2_extension import RtronCommand

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
AMENT = ROOT / "ament"
ROSDEP_KEYS = {
    "action_msgs",
    "diagnostic_msgs",
    "launch",
    "launch_ros",
    "rclpy",
    "ros2cli",
    "ros2launch",
    "std_msgs",
}
"""Checked in ros/rosdistro at 8468e88ccd (2026-08-22): Humble, Jazzy, Kilted, Lyrical, Rolling."""
ROS_IMPORT = re.compile(
    r"^ *(?:from|import) (rclpy|launch|launch_ros|rosidl\w*|ament_\w+|\w+_(?:msgs|interfaces))\b",
    re.MULTILINE,
)
EXTENSION = "rtron.cli.ros2_extension:RtronCommand"
ROS2 = """
import argparse, sys
from importlib import import_module
module, _, name = sys.argv[1].partition(":")
extension = getattr(import_module(module), name)()
parser = argparse.ArgumentParser("ros2")
command = parser.add_subparsers(dest="command").add_parser("rtron")
extension.add_arguments(command, "ros2 rtron")
sys.exit(extension.main(parser=parser, args=parser.parse_args(sys.argv[2:])))
"""
"""What `ros2` does with an extension: ros2cli is in no wheel."""


def test_the_manifest_says_what_the_package_is():
    manifest = ET.parse(AMENT / "package.xml").getroot()
    assert manifest.findtext("name") == "rtron"
    assert manifest.findtext("version") == __version__
    assert manifest.findtext("license") == "Apache-2.0"
    assert manifest.findtext("export/build_type") == "ament_python"


def test_rosdep_knows_every_dependency_and_each_import_of_ros_is_one():
    manifest = ET.parse(AMENT / "package.xml").getroot()
    keys = {depend.text for depend in manifest.iter() if depend.tag.endswith("depend")}
    assert keys <= ROSDEP_KEYS
    assert {"rclpy", "action_msgs", "launch", "launch_ros"} <= keys
    imported = {
        name
        for path in (ROOT / "src" / "rtron").rglob("*.py")
        for name in ROS_IMPORT.findall(path.read_text("utf-8"))
    }
    assert imported <= keys


def test_what_setup_installs_is_there(monkeypatch):
    pytest.importorskip("setuptools", reason="needs setuptools")
    given = {}
    monkeypatch.chdir(AMENT)
    monkeypatch.setattr("setuptools.setup", given.update)
    exec(compile((AMENT / "setup.py").read_text(), "setup.py", "exec"), {})
    files = {target: source for target, [source] in given["data_files"]}
    assert set(files) == {
        "share/ament_index/resource_index/packages",
        "share/rtron",
        "share/rtron/launch",
    }
    assert all((AMENT / source).is_file() for source in files.values())
    assert (given["name"], given["version"]) == ("rtron", __version__)
    assert "guard = rtron.cli.main:run_guard_node" in given["entry_points"]["console_scripts"]
    assert given["entry_points"]["ros2cli.command"] == [f"rtron = {EXTENSION}"]
    assert {"rtron", "rtron.cli", "rtron.guard.transport.ros2"} <= set(given["packages"])
    assert "planning/instrument/ros2/wrapper.py.in" in given["package_data"]["rtron"]


def test_programs_go_where_ros2_run_looks():
    read = configparser.ConfigParser()
    read.read(AMENT / "setup.cfg")
    assert read["install"]["install_scripts"] == "$base/lib/rtron"
    assert read["develop"]["script_dir"] == "$base/lib/rtron"


def ros2(*arguments):
    command = [sys.executable, "-c", ROS2, EXTENSION, "rtron", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_ros2_rtron_is_rtron(tmp_path):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert project["entry-points"]["ros2cli.command"] == {"rtron": EXTENSION}
    assert "Find what the nodes of an app can do" in ros2("scan", "--help").stdout
    scan = ros2("scan", write_app(tmp_path), "--launch", LAUNCH_FILE, "--fail-on", "low")
    assert (scan.returncode, scan.stderr) == (1, "")
    assert "/cmd_vel" in scan.stdout
    assert ros2("scan", tmp_path / "none").returncode == 2
    assert "From an app to a guarded app" in ros2().stderr


def test_argcomplete_completes_the_commands():
    parser = argparse.ArgumentParser()
    RtronCommand().add_arguments(parser, "ros2 rtron")
    (arguments,) = (action for action in parser._actions if action.dest == "arguments")
    assert {"scan", "guard", "settings", "model"} <= set(arguments.completer(prefix=""))


def test_colcon_builds_one_package_of_a_clone():
    found = (path.parent for path in ROOT.glob("**/package.xml"))
    packages = {path for path in found if not _left_out(path.relative_to(ROOT))}
    ignored = {path.parent for path in ROOT.glob("*/COLCON_IGNORE")}
    kept = [path for path in packages if not ignored.intersection(path.parents)]
    assert kept == [AMENT]


def _left_out(path):
    """What colcon does not look into, and what other tools make."""
    return path.parts[0] in {"build", "install"} or any(part[0] == "." for part in path.parts)


@pytest.mark.parametrize(
    ("given", "taken"),
    [
        ([], []),
        (["--plan", "p"], ["--plan", "p"]),
        (["--plan", "p", "--ros-args", "-r", "__node:=x"], ["--plan", "p"]),
    ],
)
def test_what_ros_appends_is_not_the_guards(monkeypatch, given, taken):
    monkeypatch.setattr(sys, "argv", ["guard", *given])
    monkeypatch.setattr(main, "main", lambda: None)
    main.run_guard_node()
    assert sys.argv == ["guard", "guard", *taken]
