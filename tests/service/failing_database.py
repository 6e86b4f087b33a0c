"""A database whose writes fail, as with a full disk, while it can be read."""

from contextlib import contextmanager

from sqlalchemy import event


@contextmanager
def read_only(database):
    """Let every write to a SQLite database fail until the end of the block."""

    def forbid(connection, *_):
        connection.execute("PRAGMA query_only = ON")

    def allow(connection, *_):
        connection.execute("PRAGMA query_only = OFF")

    event.listen(database.engine, "checkout", forbid)
    event.listen(database.engine, "checkin", allow)
    try:
        yield
    finally:
        event.remove(database.engine, "checkout", forbid)
        event.remove(database.engine, "checkin", allow)
