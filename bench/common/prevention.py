"""What came of an attack: what reached the base, and what of the app's commands still did."""

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from figures.figure import Figure

NAVIGATION_HZ = 10


@dataclass(frozen=True, slots=True)
class Outcome:
    """How much was sent, and reached the base; the share of the app's commands that arrived."""

    sent: int
    reached: int
    app: float


def app_share(commands: int, seconds: float) -> float:
    """Return which share of what the navigation sends in so many seconds was heard, 1 at most."""
    return min(1.0, commands / (seconds * NAVIGATION_HZ))


def outcome_figures(name: str, outcomes: Sequence[Outcome]) -> Iterator[Figure]:
    """Give the medians of both over runs, with their range."""
    sent = round(statistics.median(each.sent for each in outcomes))
    reached = [float(each.reached) for each in outcomes]
    yield Figure.of_runs(f"{name}.reached", reached, (), f"of {sent} sent")
    app = [100 * each.app for each in outcomes]
    yield Figure.of_runs(f"{name}.app", app, (), "% of the commands arrive")
