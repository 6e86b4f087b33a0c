"""A world that listens, and clients of it."""

import pytest
from world_client import clients, serving


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    with serving(tmp_path_factory.mktemp("w") / "world") as path:
        yield path


@pytest.fixture
def client(path):
    with clients(path) as connect:
        yield connect
