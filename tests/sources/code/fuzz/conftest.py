"""How many programs a run makes, and from which seed: `make fuzz` says both."""

import os

import pytest

PROGRAMS = int(os.environ.get("RTRON_FUZZ_PROGRAMS", "25"))
SEED = int(os.environ.get("RTRON_FUZZ_SEED", "1"))


def pytest_report_header():
    """Say what repeats the run."""
    return f"fuzz: {PROGRAMS} programs from seed {SEED}"


@pytest.fixture
def seeds():
    """Return the seeds of this run's programs."""
    return [f"{SEED}/{number}" for number in range(PROGRAMS)]
