"""A celled base that one test has for itself, and one that a module's tests share."""

import pytest
from celled_base import CelledBase, ros1_in_open_folder


@pytest.fixture
def open_ros1(own_runtime_folder):
    with ros1_in_open_folder() as ros1:
        yield ros1


@pytest.fixture
def base(open_ros1, driver):
    return CelledBase(open_ros1, driver)


@pytest.fixture(scope="module")
def moving_base(driver):
    """A base that navigation drives, for attacks that must leave it as they find it."""
    with ros1_in_open_folder() as ros1:
        base = CelledBase(ros1, driver)
        base.navigate()
        yield base
