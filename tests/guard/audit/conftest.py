"""Makes the intruders of the measurements importable, which are no part of the package."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[2]))


@pytest.fixture(scope="session")
def roscpp_driver(driver):
    return driver
