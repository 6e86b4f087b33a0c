import pytest
from file_tree import write
from survey_repositories import FILES, ROS2_FILES


@pytest.fixture(scope="session")
def repositories(tmp_path_factory):
    return write(tmp_path_factory.mktemp("repositories"), FILES)


@pytest.fixture(scope="session")
def ros2_repositories(tmp_path_factory):
    return write(tmp_path_factory.mktemp("checkouts"), ROS2_FILES)


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """Keep what surveys keep apart from the user's own, test by test."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
