"""A served collector on each kind of database."""

from contextlib import ExitStack

import pytest
from collector_server import CollectorServer

from rtron.service.store.database import Database

FOR_EVER = dict.fromkeys(("hello", "silence", "sending", "token"), 3600.0)
"""A peer that the machine keeps waiting is not late: only what a test is about is short."""


@pytest.fixture
def world(database):
    """Serve a collector."""
    with CollectorServer(database).serving() as served:
        yield served


@pytest.fixture
def serve(database_file):
    """Return what serves a collector that waits for ever but for the timeouts (s) it is given."""
    with ExitStack() as stack:
        database = Database(database_file)
        stack.callback(database.close)

        def begin(**timeouts):
            server = CollectorServer(database, **{**FOR_EVER, **timeouts})
            return stack.enter_context(server.serving())

        yield begin


@pytest.fixture
def small(database_file):
    """Serve a collector on SQLite."""
    database = Database(database_file)
    with CollectorServer(database).serving() as served:
        yield served
    database.close()
