"""Figures and where the apps lie."""

import json
from io import StringIO

import pytest
from rich.console import Console

from evaluation.common.datasets import MissingDatasetError, datasets_from_environ
from figures.figure import Figure
from figures.table import table, write


@pytest.mark.parametrize(
    ("ours", "at_least", "at_most", "met"),
    [
        (1, None, None, None),
        (1, 1, None, True),
        (0.99, 1, None, False),
        (1, None, 1, True),
        (1.01, None, 1, False),
        (1, 0, 2, True),
        (3, 0, 2, False),
    ],
)
def test_bounds(ours, at_least, at_most, met):
    assert Figure("x", ours, None, "share", at_least=at_least, at_most=at_most).met is met


@pytest.mark.parametrize(
    ("ours", "peer", "met"), [(3, 2, True), (3.01, 2, False), (3, None, False), (-1, 2, False)]
)
def test_a_bound_of_the_ratio(ours, peer, met):
    assert Figure("x", ours, peer, "us", ratio_at_most=1.5).met is met


@pytest.mark.parametrize(
    ("ours", "peer", "ratio"), [(1, None, None), (1, 0, None), (-1, 2, None), (1, 2, 0.5)]
)
def test_the_ratio_needs_a_peer_and_no_noise(ours, peer, ratio):
    assert Figure("x", ours, peer, "share").ratio == ratio


@pytest.mark.parametrize(
    ("ours", "peer", "ratio"),
    [
        ((1, 2, 9), (2, 4, 6), 0.5),
        ((-1, -1, -1), (2, 2, 2), 0),
        ((-3, -3, -3), (-1, -1, -1), 0),
        ((1, 1, 2), (0, 0, 4), 1000),
    ],
    ids=[
        "median of the ratios",
        "ours is faster than nothing",
        "both are",
        "the peer costs nothing",
    ],
)
def test_runs_are_compared_with_the_run_beside_them(ours, peer, ratio):
    figure = Figure.of_runs("x", ours, peer, "us", ratio_at_most=1)
    assert figure.ratio == ratio
    assert figure.met is (ratio <= 1)
    assert figure.as_json()["ours_range"] == (min(ours), max(ours))


def test_runs_without_a_peer_have_a_range_of_their_own():
    figure = Figure.of_runs("x", [4, 2, 3], (), "us", at_most=3)
    assert (figure.ours, figure.peer, figure.ratio, figure.met) == (3, None, None, True)
    assert figure.as_json()["peer_range"] is None
    console = Console(file=StringIO(), width=100)
    console.print(table("Less is better", [figure]))
    assert "3 (2 to 4)" in console.file.getvalue()


def test_the_table_says_every_bound_and_whether_it_is_kept():
    figure = Figure("x", 1500, 1000, "us", at_least=1, at_most=2000, ratio_at_most=1.25)
    console = Console(file=StringIO(), width=100)
    console.print(table("Less is better", [figure]))
    said = console.file.getvalue()
    assert "Less is better" in said
    assert "1,500 │ 1,000 │   1.5 │ us   │ >= 1 <= 2,000 ratio <= 1.25 missed" in said


def test_figures_of_other_parts_are_kept(tmp_path):
    path = tmp_path / "build" / "eval.json"
    write([Figure("a", 1, 2, "share")], path, keep=False)
    write([Figure("b", 3, None, "s")], path, keep=True)
    written = json.loads(path.read_text())
    assert written["a"] == {"ours": 1, "peer": 2, "ratio": 0.5, "unit": "share"}
    assert list(written) == ["a", "b"]
    write([Figure("c", 1, None, "s")], path, keep=False)
    assert list(json.loads(path.read_text())) == ["c"]


def test_what_is_absent_is_named(tmp_path):
    (tmp_path / "me" / "app@1").mkdir(parents=True)
    here = datasets_from_environ({"RTRON_APPS": str(tmp_path)})
    assert [path.name for path in here.repositories(["me/app@1"])] == ["app@1"]
    assert [path.name for path in here.present(["me/app@1", "me/other@2"])] == ["app@1"]
    with pytest.raises(MissingDatasetError, match="other@2"):
        here.repositories(["me/app@1", "me/other@2"])
    with pytest.raises(MissingDatasetError, match="RTRON_DATA"):
        here.truth("x.yaml")


def test_without_the_variables_all_is_absent(tmp_path):
    with pytest.raises(MissingDatasetError, match="RTRON_APPS"):
        datasets_from_environ({}).all_repositories()
    with pytest.raises(MissingDatasetError, match=r"groundtruth/x\.yaml"):
        datasets_from_environ({"RTRON_DATA": str(tmp_path)}).truth("x.yaml")
