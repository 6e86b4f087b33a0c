"""Results that are kept, and which of them still count."""

from dataclasses import replace

import pytest

from rtron.survey.app_listing import AppToScan
from rtron.survey.app_survey import AppResult, survey_app
from rtron.survey.results_file import ResultsFile, results_file
from rtron.vocabulary import InteractionGraph


@pytest.fixture
def app(tmp_path):
    launch = tmp_path / "a" / "x.launch"
    return AppToScan(top=tmp_path, repository=tmp_path / "a", launch=launch, digest="1")


@pytest.fixture
def stored(tmp_path):
    return ResultsFile(tmp_path / "results.jsonl")


def result(app, **changes):
    made = AppResult(
        app=app.name,
        repository="a",
        ros=1,
        seconds=0.5,
        survey=survey_app(app, InteractionGraph(app="x")),
    )
    return replace(made, **changes)


def test_a_result_comes_back_as_it_was(app, stored):
    stored.add(app, result(app), 60)
    assert stored.read([app], 60) == {app.name: result(app)}


def test_a_result_of_other_files_does_not_count(app, stored):
    stored.add(app, result(app), 60)
    assert stored.read([replace(app, digest="2")], 60) == {}


def test_a_line_that_was_not_written_whole_costs_itself_only(app, stored):
    stored.add(app, result(app), 60)
    other = replace(app, launch=app.launch.with_name("y.launch"))
    whole = stored.path.read_bytes()
    stored.path.write_bytes(whole + whole[:100])
    stored.add(other, result(other), 60)
    assert stored.read([app, other], 60).keys() == {app.name, other.name}


@pytest.mark.parametrize(
    ("is_final", "limit", "counts"),
    [(True, 60, True), (True, 30, True), (True, 61, False), (False, 60, False)],
)
def test_a_failure_counts_until_there_is_more_time_or_if_its_process_died(
    app, stored, is_final, limit, counts
):
    stored.add(app, result(app, survey=None, error="no", is_final=is_final), 60)
    assert bool(stored.read([app], limit)) is counts


def test_lines_that_do_not_count_any_more_are_left_out(app, stored):
    for digest in "123":
        stored.add(replace(app, digest=digest), result(app), 60)
    stored.compact([app], 60)
    assert len(stored.path.read_text().split()) == 1
    assert stored.read([app], 60) == {app.name: result(app)}


def test_nothing_is_kept_where_others_can_write(tmp_path):
    file = results_file(tmp_path)
    assert file.path is not None
    file.path.parent.chmod(0o777)
    assert results_file(tmp_path).path is None
