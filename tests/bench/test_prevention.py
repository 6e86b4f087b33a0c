"""What a bench of prevention tells of its runs."""

from bench.common.prevention import Outcome, app_share, outcome_figures


def test_the_share_of_the_app_is_that_of_what_it_sends() -> None:
    assert app_share(20, 4) == 0.5
    assert app_share(41, 4) == 1.0


def test_runs_are_told_by_their_median_and_range() -> None:
    runs = [Outcome(200, 0, 1.0), Outcome(200, 3, 0.5), Outcome(210, 1, 0.9)]
    reached, app = outcome_figures("cell.private", runs)
    assert (reached.name, reached.ours, reached.unit) == ("cell.private.reached", 1, "of 200 sent")
    assert reached.spread
    assert reached.spread.ours == (0, 3)
    assert (app.name, app.ours) == ("cell.private.app", 90)
