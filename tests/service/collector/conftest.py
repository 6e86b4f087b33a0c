"""A served collector on each kind of database."""

import pytest
from collector_server import CollectorServer

from rtron.service.store.database import Database


@pytest.fixture
def world(database):
    """Serve a collector."""
    with CollectorServer(database).serving() as served:
        yield served


@pytest.fixture
def short_timeouts(database_file):
    """Serve a collector that waits for nobody."""
    database = Database(database_file)
    with CollectorServer(
        database, hello=0.2, silence=0.4, sending=0.3, token=0.1
    ).serving() as served:
        yield served
    database.close()


@pytest.fixture
def small(database_file):
    """Serve a collector on SQLite."""
    database = Database(database_file)
    with CollectorServer(database).serving() as served:
        yield served
    database.close()
