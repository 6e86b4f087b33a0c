"""Makes the intruders of the measurements importable, which are no part of the package."""

import pytest


@pytest.fixture(scope="session")
def roscpp_driver(driver):
    return driver
