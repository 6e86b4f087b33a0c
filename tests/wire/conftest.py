"""The profile `fuzz`, and how many hostile inputs a run gave."""

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "fuzz",
    max_examples=30_000,
    derandomize=False,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
_GIVEN = pytest.StashKey[list[int]]()


def pytest_configure(config):
    config.stash[_GIVEN] = [0]


@pytest.fixture(scope="session")
def given_inputs(pytestconfig):
    """Return the one number that each fuzz test adds its inputs to."""
    return pytestconfig.stash[_GIVEN]


def pytest_terminal_summary(terminalreporter, config):
    if (number := config.stash[_GIVEN][0]) and config.getoption("--hypothesis-profile"):
        terminalreporter.write_line(f"{number} hostile inputs: each gave a value or a WireError")
