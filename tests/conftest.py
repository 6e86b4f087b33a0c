"""Where tests find their helpers, and in which order they run."""

import sys
from pathlib import Path

import pytest
from hypothesis import settings

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
settings.register_profile("default", deadline=None)
settings.load_profile("default")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    """Start with the files that start a ROS: they wait most, so none of them should be last."""
    with_ros = {item.path for item in items if item.get_closest_marker("ros1")}
    items.sort(key=lambda item: item.path not in with_ros)
