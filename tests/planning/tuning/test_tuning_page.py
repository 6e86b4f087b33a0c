"""docs/tuning.md says what the rules of thumb are."""

from pathlib import Path

import pytest

from rtron.planning.tuning import flow_priorities, run_statistics, velocity_limits
from rtron.vocabulary import PROPOSALS_SCHEMA, RUN_SCHEMA, SECOND

PAGE = " ".join((Path(__file__).parents[3] / "docs" / "tuning.md").read_text().split())


@pytest.mark.parametrize(
    "told",
    [
        f"from {run_statistics.MIN_SAMPLES} samples on (goals: {run_statistics.MIN_GOALS})",
        f"from {run_statistics.ENOUGH_SAMPLES} on (goals: {run_statistics.ENOUGH_GOALS})",
        f"longer than {run_statistics.MAX_SILENCE // SECOND} s",
        f"shorter than {run_statistics.MIN_DURATION / SECOND} s",
        f"from {velocity_limits.ENOUGH_VELOCITIES} velocities",
        RUN_SCHEMA,
        PROPOSALS_SCHEMA,
    ],
)
def test_the_page_has_the_numbers(told):
    assert told in PAGE


@pytest.mark.parametrize(
    "word", ["safety", "emergency", "stop", "collision", "bumper", "brake", "cliff", "watchdog"]
)
def test_the_page_has_the_names_that_stay_first(word):
    assert f"{word}" in PAGE
    assert flow_priorities.SAFETY_NAME.search(f"/e{word}" if word == "stop" else f"/{word}_node")
