"""What befalls a PostgreSQL database while replicas use it, done by a session of the tests' own."""

from contextlib import closing, contextmanager

import pg8000.dbapi
from sqlalchemy import make_url


class DatabaseFaults:
    """Faults of one database."""

    def __init__(self, url):
        self._url = make_url(url)

    @contextmanager
    def cut_off(self, robot):
        """Cut the connection over which the replica of a robot's guard hears of the others.

        Nobody gets a new connection until the end of the block.
        """
        lock = "SELECT pid FROM pg_locks WHERE locktype = 'advisory' AND objsubid = 2"
        owner = f"SELECT replica FROM live_guards WHERE robot = '{robot}'"
        ((listener,),) = self._run(f"{lock} AND objid = ({owner})")
        database = self._url.database
        self._run(f"ALTER DATABASE {database} ALLOW_CONNECTIONS false", "postgres")
        try:
            self._run(f"SELECT pg_terminate_backend({listener})", "postgres")
            yield
        finally:
            self._run(f"ALTER DATABASE {database} ALLOW_CONNECTIONS true", "postgres")

    @contextmanager
    def full_disk(self):
        """Let nothing be written until the end of the block."""
        self._set_read_only("on")
        try:
            yield
        finally:
            self._set_read_only("off")

    @contextmanager
    def slow_events(self):
        """Let nobody store events until the end of the block."""
        with closing(self._connect(self._url.database)) as connection:
            connection.cursor().execute("LOCK TABLE events IN ACCESS EXCLUSIVE MODE")
            yield
            connection.rollback()

    def _set_read_only(self, value):
        name = self._url.database
        self._run(f"ALTER DATABASE {name} SET default_transaction_read_only = {value}", "postgres")
        others = f"datname = '{name}' AND pid <> pg_backend_pid()"
        self._run(f"SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE {others}")

    def _run(self, statement, database=""):
        with closing(self._connect(database or self._url.database)) as connection:
            connection.autocommit = True
            cursor = connection.cursor()
            cursor.execute(statement)
            return [tuple(row) for row in cursor.fetchall()] if cursor.description else []

    def _connect(self, database):
        return pg8000.dbapi.connect("postgres", "127.0.0.1", database, self._url.port)
