"""`rtron survey`: ended and taken up again."""

import csv
import json
import signal
import subprocess
import sys
from contextlib import suppress
from io import StringIO
from pathlib import Path
from types import SimpleNamespace

import pytest
from file_tree import write
from harness import lives, wait_for
from survey_repositories import FILES

from rtron.cli.main import main
from rtron.survey.results_file import results_file

APPS = ["drive/drive_base/launch/two.launch", "other/other_app/launch/one.launch"]
MANY = 60


def command(*arguments):
    return [sys.executable, "-m", "rtron", "survey", *map(str, arguments)]


def survey(*arguments):
    return subprocess.run(command(*arguments), capture_output=True, text=True, check=False)


@pytest.fixture
def survey_here(monkeypatch, capfd):
    """Run `survey` in this process, with one process that scans: each takes seconds to start."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["rtron", *command(*arguments, "--jobs", "1")[3:]])
        with pytest.raises(SystemExit) as ended:
            main()
        printed = capfd.readouterr()
        return SimpleNamespace(returncode=ended.value.code, stdout=printed.out, stderr=printed.err)

    return run


def lines(text):
    return [{**json.loads(line), "seconds": 0} for line in text.splitlines()]


@pytest.fixture
def many(tmp_path):
    """A repository with many apps."""
    launch = FILES["drive/drive_base/launch/two.launch"]
    more = {f"drive/drive_base/launch/app_{n:02}.launch": launch for n in range(MANY)}
    return write(tmp_path / "many", {**FILES, **more})


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


def test_the_lines_of_two_processes_are_those_of_one(repositories):
    alone = survey(repositories, "--jobs", "1", "--no-cache")
    together = survey(repositories, "--jobs", "2", "--no-cache")
    assert alone.stdout.count("\n") == len(APPS)
    assert lines(together.stdout) == lines(alone.stdout)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL], ids=["ctrl-c", "kill"])
def test_a_survey_that_was_ended_goes_on_where_it_was(many, number):
    kept = results_file(many).path
    with subprocess.Popen(
        command(many, "--jobs", "1"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as running:
        wait_for(lambda: kept.exists() and kept.read_text().count('"app"'))
        scanning = _children(running.pid)
        running.send_signal(number)
        output, errors = running.communicate(timeout=60)
    assert scanning
    wait_for(lambda: not any(map(lives, scanning)))
    done = sum("digest" in line for line in kept.read_text().splitlines())
    assert 0 < done < MANY
    if number is signal.SIGINT:
        assert running.returncode == 130
        assert output.count("\n") == done
        assert f"ended after {done} of {MANY + 2} apps" in errors
    again = survey(many, "--format", "json")
    assert again.returncode == 0, again.stderr
    found = json.loads(again.stdout)
    assert (found["reused"], len(found["apps"])) == (done, MANY + 2)
    assert all("error" not in app for app in found["apps"])


def _children(process):
    """Return the processes that one has started, and those that these have."""
    ours = []
    for path in Path(f"/proc/{process}/task").glob("*/children"):
        with suppress(OSError):  # that thread or process has ended
            ours += map(int, path.read_text().split())
    return [*ours, *(below for each in ours for below in _children(each))]


def test_what_has_not_changed_is_not_scanned_again(survey_here, tmp_path):
    write(tmp_path / "repos", FILES)
    assert json.loads(survey_here(tmp_path / "repos", "--format", "json").stdout)["reused"] == 0
    assert json.loads(survey_here(tmp_path / "repos", "--format", "json").stdout)["reused"] == 2
    talker = tmp_path / "repos/other/other_app/launch/one.launch"
    talker.write_text(talker.read_text().replace("one", "three"))
    found = json.loads(survey_here(tmp_path / "repos", "--format", "json").stdout)
    assert (found["reused"], found["missing"]) == (1, 0)
    fresh = survey_here(tmp_path / "repos", "--format", "json", "--no-cache")
    assert json.loads(fresh.stdout)["reused"] == 0


def test_an_app_without_a_survey_has_a_reason(survey_here, repositories, tmp_path):
    write(tmp_path / "repos", FILES)
    bad = tmp_path / "repos/drive/drive_base/launch/bad.launch"
    bad.write_text("<launch><include file='$(find nowhere)/x.launch'/><node/></launch>")
    ran = survey_here(tmp_path / "repos")
    assert ran.returncode == 0, ran.stderr
    (failed,) = (each for each in lines(ran.stdout) if "error" in each)
    assert failed["app"] == "drive/drive_base/launch/bad.launch"
    assert failed["error"]
    assert failed["error"] in ran.stderr


def test_the_table_has_a_line_for_each_app_and_counts_them(survey_here, repositories, tmp_path):
    table = tmp_path / "table.txt"
    ran = survey_here(repositories, "--table", "-o", table)
    assert ran.returncode == 0, ran.stderr
    text = table.read_text()
    assert text.startswith("2 apps\n")
    for app in APPS:
        assert f"\n  {app} " in text
    assert "GR-ST  1 (50.0%)" in text


def test_a_spreadsheet_gets_a_row_for_each_app(survey_here, repositories, tmp_path):
    path = tmp_path / "apps.csv"
    assert survey_here(repositories, "-o", path).returncode == 0
    two, one = csv.DictReader(StringIO(path.read_text()))
    assert [two["app"], one["app"]] == APPS
    assert (two["GR-ST"], one["GR-ST"], two["error"]) == ("1", "0", "")


def test_a_folder_without_apps_is_an_error(survey_here, tmp_path):
    ran = survey_here(tmp_path)
    assert (ran.returncode, ran.stdout) == (2, "")
    assert "no app can be scanned" in ran.stderr
