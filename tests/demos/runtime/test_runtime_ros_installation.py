"""What the demo runs on, and what of the user's environment its processes see."""

import pytest

from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.isolation import shared_environ
from rtron.demos.runtime.ros_installation import PYTHON_VARIABLE, find_ros_python
from rtron.errors import SourceError


def test_nothing_leads_to_what_the_user_runs(tmp_path, monkeypatch):
    theirs = ("ROS_DOMAIN_ID", "RTRON_SERVICE", "FASTDDS_DEFAULT_PROFILES_FILE", "DEMO_MAP")
    for name in theirs:
        monkeypatch.setenv(name, "theirs")
    monkeypatch.setenv("AMENT_PREFIX_PATH", "/opt/ros/x")
    found = shared_environ(tmp_path, tmp_path)
    assert not found.keys() & set(theirs)
    assert found["AMENT_PREFIX_PATH"] == "/opt/ros/x"


def test_a_relative_python_path_leads_to_the_same_from_another_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", "mine::yours")
    _, *found = shared_environ(tmp_path, tmp_path)["PYTHONPATH"].split(":")
    assert found == [str(tmp_path / "mine"), str(tmp_path / "yours")]


def test_a_python_that_is_named_is_taken_wherever_it_is_started_from(tmp_path, monkeypatch):
    python = tmp_path / "python"
    python.write_text("#!/bin/sh\nexit 0\n")
    python.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(PYTHON_VARIABLE, "./python")
    assert find_ros_python(2) == python


def test_a_python_without_ros_2_is_told(tmp_path, monkeypatch):
    monkeypatch.setenv(PYTHON_VARIABLE, str(tmp_path / "python"))
    with pytest.raises(SourceError, match=f"{PYTHON_VARIABLE}=.*cannot run") as caught:
        find_ros_python(2)
    assert "source a ROS 2" in caught.value.help


def test_without_its_programs_there_is_no_ros_1(monkeypatch):
    monkeypatch.setattr("shutil.which", lambda _: None)
    with pytest.raises(SourceError, match="rosmaster, roslaunch not found") as caught:
        find_ros_python(1)
    assert "make setup" in caught.value.help


def test_a_folder_for_sockets_that_is_too_long_is_told(tmp_path, monkeypatch):
    folder = tmp_path / ("x" * 90)
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    python = tmp_path / "python"
    python.write_text("#!/bin/sh\nexit 0\n")
    python.chmod(0o755)
    monkeypatch.setenv(PYTHON_VARIABLE, str(python))
    with (
        pytest.raises(SourceError, match="below TMPDIR") as caught,
        demo_environment(2, tmp_path / "demo"),
    ):
        raise AssertionError("it has begun")
    assert str(folder) in caught.value.help
    assert list(folder.iterdir()) == []
