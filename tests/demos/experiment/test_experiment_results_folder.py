"""The folder of the results: what is refused, what is replaced, what is left after a failure."""

import json

import pytest

from rtron.cli.commands.demo import preserve_logs
from rtron.demos.experiment import results
from rtron.demos.experiment.results import (
    copy_logs,
    prepare_results_folder,
    remove_earlier_results,
)
from rtron.errors import InputError, SourceError


@pytest.fixture
def work(tmp_path):
    log = tmp_path / "work" / "log"
    log.mkdir(parents=True)
    (log / "01-world.log").write_text("no world")
    return tmp_path / "work"


@pytest.fixture
def out(tmp_path):
    (tmp_path / "out").mkdir()
    return tmp_path / "out"


def test_it_is_made_with_its_parents(tmp_path):
    assert prepare_results_folder(tmp_path / "new" / "out").is_dir()
    assert list(prepare_results_folder(tmp_path / "new" / "out").iterdir()) == []


def test_a_file_in_the_way_is_no_folder(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="file: is no folder"):
        prepare_results_folder(tmp_path / "file")
    with pytest.raises(InputError, match="out: Not a directory"):
        prepare_results_folder(tmp_path / "file" / "out")


@pytest.mark.parametrize("results", [None, "[]", '{"schema": "rtron.graph/1"}', "\udcff"])
def test_other_files_are_refused(out, results):
    (out / "mine").write_text("mine")
    if results is not None:
        (out / "results.json").write_text(results, errors="surrogateescape")
    with pytest.raises(InputError, match="holds other files") as caught:
        prepare_results_folder(out)
    assert "-o" in caught.value.help


def test_earlier_results_are_not(out):
    (out / "mine").write_text("mine")
    (out / "results.json").write_text(json.dumps({"schema": results.SCHEMA, "ros": 1}, indent=1))
    assert prepare_results_folder(out) == out


def test_that_it_can_be_written_to_is_tried(out, monkeypatch):
    def refused(**_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(results, "TemporaryFile", refused)
    with pytest.raises(InputError, match="out: Permission denied"):
        prepare_results_folder(out)


def test_earlier_results_are_cleared_and_nothing_else(out, tmp_path):
    (tmp_path / "others").mkdir()
    for name in ("others/kept", "out/mine", "out/report.html", "out/msr-velocity.png"):
        (tmp_path / name).write_text("")
    (out / "log").symlink_to(tmp_path / "others")
    (out / "results.json").symlink_to(tmp_path / "others" / "kept")
    remove_earlier_results(out)
    assert [path.name for path in out.iterdir()] == ["mine"]
    assert (tmp_path / "others" / "kept").exists()


def test_a_failure_leaves_its_logs(work, out, capsys):
    (out / "log").mkdir()
    (out / "log" / "old.log").write_text("")
    with pytest.raises(SourceError, match="no world"), preserve_logs(work, out):
        raise SourceError("no world")
    assert [path.name for path in (out / "log").iterdir()] == ["01-world.log"]
    assert capsys.readouterr().err == f"The logs are in {out / 'log'}\n"
    assert prepare_results_folder(out) == out


def test_a_failure_before_there_are_logs_leaves_all_as_it_was(tmp_path, out):
    (out / "report.html").write_text("")
    assert copy_logs(tmp_path / "none", out, "no ROS") is None
    assert (out / "report.html").exists()
