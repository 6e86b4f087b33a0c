"""docs/tuning.md says what the rules of thumb are."""

from pathlib import Path

import pytest

from rtron.planning.tune import evidence, limits, order
from rtron.vocabulary import PROPOSALS_SCHEMA, RUN_SCHEMA, SECOND

PAGE = " ".join((Path(__file__).parents[2] / "docs" / "tuning.md").read_text().split())


@pytest.mark.parametrize(
    "told",
    [
        f"from {evidence.FEW} samples on (goals: {evidence.FEW_GOALS})",
        f"from {evidence.ENOUGH} on (goals: {evidence.ENOUGH_GOALS})",
        f"longer than {evidence.LONGEST_SILENCE // SECOND} s",
        f"shorter than {evidence.SHORTEST / SECOND} s",
        f"from {limits.ENOUGH_SPEEDS} velocities",
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
    assert order.SAFETY.search(f"/e{word}" if word == "stop" else f"/{word}_node")
