"""The figures of the evaluation, and the page of all runs."""

from dataclasses import replace

import pytest
from demo_runs import make_run, runs_by_variant

from evaluation.common.adaptation import SlowdownResult
from evaluation.common.demos import figures_of_adaptations, figures_of_case, runs_page
from rtron.demos.metrics.case_run import Variant


def figures(runs):
    return {each.name: each for each in figures_of_case("demo", runs)}


def worlds(count, **guarded):
    """Return the runs of some worlds, the guarded ones changed."""
    runs = [run for seed in range(count) for run in runs_by_variant(seed=seed).values()]
    return [replace(run, **guarded) if run.variant is Variant.GUARDED else run for run in runs]


def test_the_figures_of_a_case_that_goes_well():
    found = figures(worlds(20))
    assert {name: each.ours for name, each in found.items()} == pytest.approx(
        {
            "demo.harmed": 20,
            "demo.collided": 20,
            "demo.guarded.attacked": 20,
            "demo.guarded.harmed": 0,
            "demo.guarded.completed": 20,
            "demo.guarded.delivered": 0,
            "demo.guarded.slower": 0,
            "demo.guarded.slowest": 0,
        }
    )
    assert all(each.met is not False for each in found.values())


@pytest.mark.parametrize(
    ("change", "missed"),
    [
        ({"harm": "collision", "completed": False}, {"harmed", "completed"}),
        ({"time_to_goal": 20.2}, {"slower"}),
        ({"attack": make_run(Variant.ATTACKED).attack}, {"delivered"}),
    ],
)
def test_what_goes_wrong_misses_its_bound(change, missed):
    found = figures(worlds(20, **change))
    wrong = {name.rpartition(".")[2] for name, each in found.items() if each.met is False}
    assert wrong == missed


def test_an_adaptation_that_is_late_or_never_comes_misses_its_bound():
    soon = [SlowdownResult(seed, 0.17, 0.3) for seed in range(20)]
    assert [each.met for each in figures_of_adaptations(1, soon)] == [True, True]
    for after in (0.51, None):
        late = [*soon[:19], SlowdownResult(19, 0.17, after)]
        assert [each.met for each in figures_of_adaptations(1, late)] == [False, False]


def test_the_page_has_a_line_for_each_world():
    text = runs_page(
        worlds(3), {1: [SlowdownResult(7, 0.1694, 0.31), SlowdownResult(8, 0.1694, None)]}
    )
    assert "## GR on ROS 1, at 2 simulated seconds a second" in text
    (line,) = [line for line in text.splitlines() if line.startswith("| 2 |")]
    assert line.startswith("| 2 | 19.1 s | collision | yes | 700 / 180 | completed | 19.1 s |")
    assert line.endswith("| 700 / 0 | stopped | 0.00 m |")
    assert "| 7 | 0.31 s | 0.169 m/s |" in text
    assert "| 8 | never | 0.169 m/s |" in text
