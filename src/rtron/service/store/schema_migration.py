"""Bringing a database to the schema of this version (Alembic), in one transaction."""

from functools import cache
from pathlib import Path
from secrets import token_hex
from typing import TYPE_CHECKING

from sqlalchemy import Connection, Engine, insert, inspect
from sqlalchemy.exc import DBAPIError

from rtron.errors import InputError, SourceError
from rtron.service.store.fleet.rollout_tables import RolloutRow
from rtron.service.store.incidents import IncidentRow
from rtron.service.store.notices import NoticeChannelRow
from rtron.service.store.partitions.event_partitions import make_partition
from rtron.service.store.tables import Table

if TYPE_CHECKING:
    from alembic.script import ScriptDirectory

_TABLES_ELSEWHERE = (RolloutRow, IncidentRow, NoticeChannelRow)
"""Their modules are imported, so that `Table.metadata` has all tables."""
_SCRIPT_FOLDER = Path(__file__).with_name("migrations")
_SCRIPT_NAMES = "versions/r[0-9]*_*.py"
MIN_POSTGRESQL = (14,)
"""The oldest version of PostgreSQL that drops partitions while others write."""
_ADVISORY_LOCK_KEY = 0x7274726F6E
"""Of PostgreSQL's advisory locks, ours: two services that start at once migrate in turn."""


def migrate(engine: Engine) -> None:
    """Bring the schema up to date; a crash leaves it as it was.

    InputError for what is no database of RTron's or one of a newer RTron, SourceError when the
    server does not answer.
    """
    name = _display_name(engine)
    try:
        with engine.connect() as connection, connection.begin():
            _check_version(connection)
            if _is_current(connection):
                return
            _lock(connection)
            if _known_revision(connection, name):
                _upgrade(connection)
            else:
                _create(connection)
    except DBAPIError as error:
        raise _unusable_database(engine, name, error) from None


def head_revision() -> str:
    """Return the newest revision of the schema."""
    newest = max(_SCRIPT_FOLDER.glob(_SCRIPT_NAMES))
    return newest.stem.partition("_")[0].removeprefix("r")


@cache
def _scripts() -> "ScriptDirectory":
    """Return the migrations, which are modules: they are loaded once."""
    from alembic.script import ScriptDirectory  # noqa: PLC0415 - only an old schema needs it

    return ScriptDirectory(_SCRIPT_FOLDER)


def _check_version(connection: Connection) -> None:
    version = connection.dialect.server_version_info or MIN_POSTGRESQL
    if connection.dialect.name != "sqlite" and version < MIN_POSTGRESQL:
        message = f"PostgreSQL {version[0]} is too old"
        raise InputError(message, help=f"use PostgreSQL {MIN_POSTGRESQL[0]}, or newer")


def _is_current(connection: Connection) -> bool:
    """Tell whether the schema is the newest, without Alembic: it takes long to load."""
    if not inspect(connection).has_table("alembic_version"):
        return False
    versions = connection.exec_driver_sql("SELECT version_num FROM alembic_version")
    return versions.scalars().all() == [head_revision()]


def _lock(connection: Connection) -> None:
    """Lock: Python's sqlite3 would run each statement that makes a table by itself."""
    if connection.dialect.name == "sqlite":
        connection.exec_driver_sql("BEGIN IMMEDIATE")
    else:
        connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({_ADVISORY_LOCK_KEY})")


def _known_revision(connection: Connection, name: str) -> str | None:
    """Return the schema's revision, None if there is none yet; InputError for a strange one."""
    from alembic.runtime.migration import MigrationContext  # noqa: PLC0415 - likewise

    revision = MigrationContext.configure(connection).get_current_revision()
    known = {script.revision for script in _scripts().walk_revisions()}
    if revision and revision not in known:
        help = "start the newest RTron that has used it, or give another --database"
        if revision < min(known):
            help = "give another --database: from schemas before the first release there is no way"
        message = f"its schema {revision} is unknown to this RTron, which has {head_revision()}"
        raise InputError(message, path=name, help=help)
    foreign_tables = Table.metadata.tables.keys() & set(inspect(connection).get_table_names())
    if foreign_tables and not revision:
        message = f"it has tables of another program: {', '.join(sorted(foreign_tables))}"
        raise InputError(message, path=name, help="give another --database")
    return revision


def _create(connection: Connection) -> None:
    """Make the newest schema in an empty database."""
    from alembic.runtime.migration import MigrationContext  # noqa: PLC0415 - likewise

    Table.metadata.create_all(connection)
    if connection.dialect.name != "sqlite":
        connection.exec_driver_sql("ALTER TABLE live_guards SET UNLOGGED")
        for number in range(2):
            make_partition(connection, number)
    connection.execute(insert(NoticeChannelRow).values(name=f"rtron_{token_hex(16)}"))
    MigrationContext.configure(connection).stamp(_scripts(), "head")


def _upgrade(connection: Connection) -> None:
    from alembic.config import Config  # noqa: PLC0415 - likewise
    from alembic.runtime.environment import EnvironmentContext  # noqa: PLC0415 - likewise

    scripts = _scripts()
    with EnvironmentContext(
        Config(),
        scripts,
        fn=lambda revision, _: scripts._upgrade_revs("head", revision),  # noqa: SLF001 - its commands' way
    ) as context:
        context.configure(connection=connection, transactional_ddl=True)
        context.run_migrations()


def _display_name(engine: Engine) -> str:
    if engine.dialect.name == "sqlite":
        return str(engine.url.database)
    return engine.url.render_as_string(hide_password=True)


def _unusable_database(engine: Engine, name: str, error: DBAPIError) -> InputError | SourceError:
    if engine.dialect.name == "sqlite":
        return InputError(str(error.orig), path=name, help="give a file of RTron's, or a new one")
    return SourceError(f"{name}: {error.orig}", help="is the server there, and may we log in?")
