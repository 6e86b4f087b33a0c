"""Where tests find their helpers, and in which order they run."""

import gc
import os
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from example_budget import SHORT, WHOLE

pytest_plugins = ["shared_fixtures", "time_limits"]

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

# Participants of one process of tests meet over the network, as those of an app do: within a
# process Fast DDS 3.2 may never give one the endpoints of another, about once in two hundred.
os.environ["FASTDDS_DEFAULT_PROFILES_FILE"] = str(TESTS / "ros2" / "separate.xml")

# A run says the same everywhere and every time: Hypothesis would take other examples in CI. A
# deadline, and how long it takes to make examples, would be absolute times.
settings.register_profile(
    "default",
    max_examples=SHORT,
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.register_profile(
    "thorough", settings.get_profile("default"), max_examples=WHOLE, derandomize=False
)
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


gc.set_threshold(100_000)  # thousands of tests live as long as the process: look for garbage seldom


def pytest_collection_finish():
    """Look for no garbage among the tests themselves."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(tryfirst=True)
def pytest_itemcollected(item):
    """Mark what runs with coverage: all but what measures time, which coverage would change."""
    is_timed = item.get_closest_marker("timed") or item.get_closest_marker("ros2")
    if str(item.path).startswith(COVERED) and not is_timed:
        item.add_marker("covered")


_LONGEST_FIRST = (TESTS / "longest_first.txt").read_text("utf-8").split()
_PLACES = {TESTS.parent / path: place for place, path in enumerate(_LONGEST_FIRST)}


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    """Start with the files that take longest, so that no worker is left alone with one."""
    items.sort(key=lambda item: _PLACES.get(item.path, len(_PLACES)))
