"""Every app below a folder is scanned, here and on a cluster."""

import json
import shutil
import subprocess
import sys

import pytest
from local_cluster import local_cluster

from rtron.errors import InputError
from rtron.sources.launch.ros1 import file_search
from rtron.survey.app_listing import find_apps

APPS = ["drive/drive_base/launch/two.launch", "other/other_app/launch/one.launch"]


def survey(*arguments):
    command = [sys.executable, "-m", "rtron", "survey", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_an_app_is_a_launch_file_that_no_other_includes_and_that_needs_nothing(repositories):
    left = []
    assert [each.name for each in find_apps(repositories, left.append)] == APPS
    asks, broken = left
    assert str(asks) == "drive/drive_base/launch/asks.launch: needs the arguments robot"
    assert broken.location == "drive/drive_base/launch/broken.launch"


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


def test_each_app_is_a_line(repositories):
    ran = survey(repositories)
    assert ran.returncode == 0, ran.stderr
    two, one = map(json.loads, ran.stdout.splitlines())
    assert [two["app"], one["app"]] == APPS
    assert (two["nodes"], one["nodes"]) == (3, 2)
    assert two["risks"]["GR-ST"] == 1
    assert one["risks"]["GR-ST"] == 0
    assert two["coordination_nodes"]["grcn"] == 1
    assert "asks.launch: needs the arguments robot" in ran.stderr


@pytest.mark.long
def test_the_lines_of_processes_and_of_a_cluster_are_the_same(repositories):
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    alone = survey(repositories, "--jobs", "1")
    with local_cluster() as address:
        together = survey(repositories, "--cluster", address)
    processes = survey(repositories, "--jobs", "2")
    assert alone.stdout.count("\n") == len(APPS)
    assert together.stdout == processes.stdout == alone.stdout


def test_the_table_counts_apps(repositories, tmp_path):
    table = tmp_path / "table.txt"
    ran = survey(repositories, "--table", "-o", table)
    assert ran.returncode == 0, ran.stderr
    text = table.read_text()
    assert text.startswith("2 apps\n")
    assert "GR-ST  1 (50.0%)" in text


def test_a_folder_without_apps_is_an_error(tmp_path):
    ran = survey(tmp_path)
    assert (ran.returncode, ran.stdout) == (2, "")
    assert "no app can be scanned" in ran.stderr


def test_both_a_cluster_and_processes_are_an_error(repositories):
    ran = survey(repositories, "--jobs", "2", "--cluster", "tcp://127.0.0.1:1")
    assert ran.returncode == 2
    assert "both --cluster and --jobs" in ran.stderr
