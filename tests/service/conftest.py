"""What tests of the security service use: real databases of both kinds."""

import pytest
from postgresql_server import PostgreSQL, programs

from rtron.service.store.database import Database


@pytest.fixture(scope="session")
def postgresql():
    """Run a PostgreSQL server of our own until the end."""
    if programs() is None:
        pytest.skip("Debian's postgresql is not installed: make setup")
    server = PostgreSQL()
    yield server
    server.stop()


@pytest.fixture(params=["sqlite", "postgresql"])
def where(request, tmp_path):
    """Give the place of a new, empty database of each kind."""
    if request.param == "sqlite":
        return tmp_path / "rtron.db"
    return request.getfixturevalue("postgresql").new_database()


@pytest.fixture
def database(where):
    """Give a new database of each kind."""
    opened = Database(where)
    yield opened
    opened.close()
