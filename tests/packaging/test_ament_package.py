"""RTron as an ament_python package, as far as that can be seen without colcon."""

import configparser
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from rtron import __version__
from rtron.cli import main

ROOT = Path(__file__).parents[2]
AMENT = ROOT / "ament"


def test_the_manifest_says_what_the_package_is():
    manifest = ET.parse(AMENT / "package.xml").getroot()
    assert manifest.findtext("name") == "rtron"
    assert manifest.findtext("version") == __version__
    assert manifest.findtext("license") == "Apache-2.0"
    assert manifest.findtext("export/build_type") == "ament_python"
    assert "rclpy" in [depend.text for depend in manifest.iter("exec_depend")]


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
    assert {"rtron", "rtron.cli", "rtron.guard.transport.ros2"} <= set(given["packages"])
    assert "planning/instrument/ros2/wrapper.py.in" in given["package_data"]["rtron"]


def test_programs_go_where_ros2_run_looks():
    read = configparser.ConfigParser()
    read.read(AMENT / "setup.cfg")
    assert read["install"]["install_scripts"] == "$base/lib/rtron"
    assert read["develop"]["script_dir"] == "$base/lib/rtron"


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
