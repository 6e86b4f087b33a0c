"""How many programs of each client library a run makes, and from which seed (`make fuzz`)."""

import os

import pytest

PROGRAMS = int(os.environ.get("FUZZ_PROGRAMS", "25"))
SEED = int(os.environ.get("FUZZ_SEED", "0"))


@pytest.fixture
def seeds():
    """Return the seeds of this run's programs."""
    return [f"{SEED}/{number}" for number in range(PROGRAMS)]
