"""Which launch files a folder holds, and that those of real apps can be read."""

import os
from pathlib import Path

import pytest

from rtron.errors import InputError
from rtron.sources.launch.common.launch_file import LaunchFileInfo
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros1 import file_search
from rtron.sources.launch.ros1.file_search import find_launch_files
from rtron.sources.launch.ros1.reader import read_launch


def write(path, text="<launch/>"):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def test_launch_files_are_listed_with_package_and_arguments(tmp_path):
    write(tmp_path / "src/p/package.xml", "<package><name>q</name></package>")
    args = (
        '<arg name="b"/><arg name="a" doc="d"/><arg name="c" default=""/><arg name="d" value="1"/>'
    )
    launch = write(tmp_path / "src/p/launch/x.launch", f"<launch>{args}</launch>")
    other = write(tmp_path / "y.launch.xml")
    write(tmp_path / "src/p/launch/x.xml")
    write(tmp_path / ".git/z.launch")
    assert find_launch_files([tmp_path]) == (
        LaunchFileInfo(path=launch, package="q", required=("b", "a"), optional=("c",)),
        LaunchFileInfo(path=other),
    )
    assert find_launch_files([tmp_path, tmp_path / "src"]) != ()
    assert len(find_launch_files([tmp_path / "src", tmp_path / "src/p"])) == 1


@pytest.mark.parametrize("marker", ["AMENT_IGNORE", "CATKIN_IGNORE", "COLCON_IGNORE"])
def test_what_builds_leave_out_has_no_launch_files(tmp_path, marker):
    write(tmp_path / "install" / marker, "")
    for place in ("src", "install/p/share"):
        write(tmp_path / place / "p/package.xml", "<package><name>p</name></package>")
        write(tmp_path / place / "p/launch/x.launch")
    assert [each.path for each in find_launch_files([tmp_path])] == [
        tmp_path / "src/p/launch/x.launch"
    ]


@pytest.mark.parametrize(
    "body",
    [
        '<node pkg="p" exec="e"/>',
        '<let name="a" value="b"/>',
        '<group><node_container pkg="p" exec="e" name="n"/></group>',
        '<include file="$(find-pkg-share p)/x.launch.xml"/>',
        '<node pkg="p" type="t" name="$(var n)"/>',
    ],
)
def test_launch_files_of_ros_2_are_left_out(tmp_path, body):
    write(tmp_path / "x.launch.xml", f"<launch>{body}</launch>")
    write(tmp_path / "x.launch.py", "raise SystemExit")
    assert find_launch_files([tmp_path]) == ()


def test_an_argument_with_a_default_under_one_condition_is_optional(tmp_path):
    args = '<arg name="a" if="$(arg b)"/><arg name="a" default="1" unless="$(arg b)"/>'
    write(tmp_path / "x.launch", f"<launch>{args}</launch>")
    assert find_launch_files([tmp_path])[0].optional == ("a",)


@pytest.mark.parametrize(
    "text", ["<launch>", "", "<robot/>", '<!DOCTYPE x [<!ENTITY a "b">]><launch/>']
)
def test_a_broken_file_is_listed_with_its_fault(tmp_path, text):
    path = write(tmp_path / "x.launch", text)
    (found,) = find_launch_files([tmp_path])
    assert found.error.startswith(str(path))


def test_links_that_go_in_circles_end(tmp_path):
    write(tmp_path / "a/x.launch")
    (tmp_path / "a/loop").symlink_to(tmp_path)
    assert len(find_launch_files([tmp_path])) == 1


def test_a_deep_folder_is_listed_with_its_fault(tmp_path, deep_folder):
    deep_folder(tmp_path)
    write(tmp_path / "x.launch")
    good, deep = find_launch_files([tmp_path])
    assert (good.path, good.error) == (tmp_path / "x.launch", "")
    assert deep.path == tmp_path.joinpath(*["d"] * 101)
    assert deep.error == f"{deep.path}: lies more than 100 folders deep"


def test_a_folder_without_end_is_an_error(tmp_path, monkeypatch):
    monkeypatch.setattr(file_search, "MAX_FOLDERS", 3)
    for name in "abc":
        (tmp_path / name).mkdir()
    with pytest.raises(InputError, match="more than 3 folders"):
        find_launch_files([tmp_path])


def read(launch, packages):
    """Return why a launch file of an app is not read, guessing its arguments."""
    try:
        read_launch(launch.path, dict.fromkeys(launch.required, "1"), packages, {})
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.skipif("RTRON_APPS" not in os.environ, reason="RTRON_APPS names no folder of apps")
def test_launch_files_of_real_apps_are_read():
    faults = []
    for repo in sorted(Path(os.environ["RTRON_APPS"]).glob("*/*")):
        packages = find_packages([repo], {})
        faults += [read(launch, packages) for launch in find_launch_files([repo])]
    own = [fault for fault in faults if fault and "needs a value" not in fault]
    assert faults
    assert len(own) <= 0.01 * len(faults)
