"""A database as an older RTron has left it."""

from contextlib import contextmanager

from alembic.config import Config
from alembic.runtime.environment import EnvironmentContext
from sqlalchemy import create_engine

from rtron.service.store import schema_migration
from rtron.service.store.database import _url


@contextmanager
def old_database(where, revision):
    """Give a connection to a new database whose schema is of a revision; it is committed."""
    engine = create_engine(_url(where))
    scripts = schema_migration._scripts()
    with (
        engine.begin() as connection,
        EnvironmentContext(
            Config(), scripts, fn=lambda current, _: scripts._upgrade_revs(revision, current)
        ) as context,
    ):
        context.configure(connection=connection, transactional_ddl=True)
        context.run_migrations()
        yield connection
    engine.dispose()
