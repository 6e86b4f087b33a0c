"""Which launch files are apps, and which repositories each may need."""

import os
import shutil

import pytest
from file_tree import write
from survey_repositories import FILES, MANIFEST

from rtron.errors import InputError
from rtron.sources.launch.ros1 import file_search
from rtron.survey.app_listing import find_apps

APPS = ["drive/drive_base/launch/two.launch", "other/other_app/launch/one.launch"]


def test_an_app_is_a_launch_file_that_no_other_includes_and_that_needs_nothing(repositories):
    left = []
    assert [each.name for each in find_apps(repositories, left.append)] == APPS
    asks, broken = left
    assert str(asks) == "drive/drive_base/launch/asks.launch: needs the arguments robot"
    assert broken.location == "drive/drive_base/launch/broken.launch"


def test_a_launch_file_of_ros_2_that_another_names_is_no_app(ros2_repositories):
    left = []
    (app,) = find_apps(ros2_repositories, left.append)
    assert (app.name, app.ros) == ("me/app@def5678/turtle_app/launch/drive.launch.xml", 2)
    assert app.repository_name == "me/app@def5678"
    assert {each.location.rpartition("/")[2]: each.reason for each in left} == {
        "asks.launch.py": "needs the arguments robot",
        "check.launch.xml": "is a test",
    }


def test_an_app_needs_the_repositories_of_packages_that_its_own_depend_on(
    repositories, ros2_repositories
):
    two, one = find_apps(repositories, print)
    assert (two.others, one.others) == ((), (repositories / "drive",))
    (app,) = find_apps(ros2_repositories, print)
    assert app.others == (ros2_repositories / "me/base@abc1234",)


def test_a_package_of_the_other_ros_is_not_needed(ros2_repositories, tmp_path):
    shutil.copytree(ros2_repositories, tmp_path, dirs_exist_ok=True)
    manifest = MANIFEST.format("turtle_base", "rospy")
    (tmp_path / "me/base@abc1234/turtle_base/package.xml").write_text(manifest)
    (app,) = (each for each in find_apps(tmp_path, print) if each.name.endswith("drive.launch.xml"))
    assert app.others == ()


def digests(top):
    return {each.name: each.digest for each in find_apps(top, print)}


def test_the_digest_changes_with_any_file_that_the_app_may_need(tmp_path):
    before = digests(write(tmp_path, FILES))
    assert digests(tmp_path) == before
    manifest = tmp_path / "other/other_app/package.xml"
    manifest.write_text(manifest.read_text() + "\n")
    changed = digests(tmp_path)
    assert [name for name in APPS if changed[name] != before[name]] == APPS[1:]
    os.utime(tmp_path / "drive/drive_base/scripts/base", ns=(1, 1))
    assert [name for name in APPS if digests(tmp_path)[name] != changed[name]] == APPS


def test_a_repository_without_end_costs_itself_only(repositories, tmp_path, monkeypatch):
    left = []
    shutil.copytree(repositories, tmp_path, dirs_exist_ok=True)
    (tmp_path / "other/more/and/more").mkdir(parents=True)
    monkeypatch.setattr(file_search, "MAX_FOLDERS", 4)
    assert [each.name for each in find_apps(tmp_path, left.append)] == APPS[:1]
    assert f"{tmp_path / 'other'}: has more than 4 folders" in map(str, left)


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(InputError):
        list(find_apps(tmp_path / "none", print))
