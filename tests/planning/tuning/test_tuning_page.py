"""docs/tuning.md says what the rules of thumb are."""

from pathlib import Path

import pytest

from rtron.planning.tuning import duration_fit, flow_priorities, velocity_limits
from rtron.vocabulary import PROPOSALS_SCHEMA, RUN_SCHEMA, SECOND

PAGE = " ".join((Path(__file__).parents[3] / "docs" / "tuning.md").read_text().split())


@pytest.mark.parametrize(
    "told",
    [
        f"from {duration_fit.MIN_SAMPLES} samples on (goals: {duration_fit.MIN_GOALS})",
        f"from {duration_fit.ENOUGH_SAMPLES} on (goals: {duration_fit.ENOUGH_GOALS})",
        f"longer than {duration_fit.MAX_SILENCE // SECOND} s",
        f"shorter than {duration_fit.MIN_DURATION / SECOND} s",
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
