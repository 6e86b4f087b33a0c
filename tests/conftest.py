"""Where tests find their helpers, and in which order they run."""

import sys
from pathlib import Path

import pytest
from hypothesis import settings

from example_budget import SHORT, WHOLE

pytest_plugins = ["shared_fixtures"]

TESTS = Path(__file__).parent
_NO_HELPERS = {"hardcases", "launch_double", "nodes"}
"""Folders of programs that tests start: what they import is their own."""


def _helper_folders():
    """Yield the folders of modules that tests import by name, whichever folder they are in."""
    for path in TESTS.rglob("*.py"):
        is_helper = not path.stem.startswith(("test_", "conftest"))
        if is_helper and not _NO_HELPERS & set(path.parts):
            yield str(path.parent)


sys.path += sorted({*_helper_folders(), str(TESTS.parent), str(TESTS.parent / "scripts")})

# A deadline would be an absolute time: on a busy machine any example may take longer.
settings.register_profile("default", deadline=None, max_examples=SHORT)
settings.register_profile("thorough", deadline=None, max_examples=WHOLE)
settings.load_profile("default")


COVERED = tuple(
    str(TESTS / path)
    for path in (
        "policies/",
        "risks/",
        "coherence/",
        "vocabulary/",
        "planning/plan_file/test_read_",
    )
)
"""Where the tests are that run every branch of what they test; `make coverage` runs them."""


@pytest.hookimpl(tryfirst=True)
def pytest_itemcollected(item):
    """Mark what runs with coverage: all but what measures time, which coverage would change."""
    is_timed = item.get_closest_marker("timed") or item.get_closest_marker("ros2")
    if str(item.path).startswith(COVERED) and not is_timed:
        item.add_marker("covered")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    """Start with the files that start a ROS: they wait most, so none of them should be last."""
    with_ros = {item.path for item in items if item.get_closest_marker("ros1")}
    items.sort(key=lambda item: item.path not in with_ros)
