import shutil
import sqlite3
from contextlib import closing
from functools import partial
from threading import Thread

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import create_engine, inspect, text

from rtron.errors import InputError, SourceError
from rtron.service.store import schema_migration
from rtron.service.store.database import Database
from rtron.service.store.schema_migration import head_revision, migrate
from rtron.service.store.tables import Table


def is_no_partition(name, kind, _parents):
    return kind != "table" or not name.startswith("events_p")


def is_of_dialect(dialect, item, *_):
    condition = getattr(item, "_ddl_if", None)
    return condition is None or condition.dialect == dialect


def test_migrations_lead_to_the_tables(database):
    with database.engine.connect() as connection:
        options = {
            "compare_type": True,
            "include_name": is_no_partition,
            "include_object": partial(is_of_dialect, connection.dialect.name),
        }
        context = MigrationContext.configure(connection, opts=options)
        assert compare_metadata(context, Table.metadata) == []
        assert context.get_current_revision() == head_revision()


def test_partial_indexes_are_partial(database):
    with database.engine.connect() as connection:
        indexes = {each["name"]: each for each in inspect(connection).get_indexes("events")}
    for name, condition in (("events_of_note", "info"), ("events_counts", "counts")):
        options = indexes[name]["dialect_options"]
        assert any(condition in str(value) for value in options.values())


def test_a_missing_column_is_seen(database):
    with database.engine.begin() as connection:
        connection.execute(text("ALTER TABLE webhooks DROP COLUMN failing"))
        assert compare_metadata(MigrationContext.configure(connection), Table.metadata)


def test_migrating_again_changes_nothing(database):
    with database.session() as session:
        session.execute(text("INSERT INTO robots (name, created) VALUES ('r', 1)"))
    migrate(database.engine)
    with database.session() as session:
        assert session.scalar(text("SELECT count(*) FROM robots")) == 1


NEXT = """
import sqlalchemy as sa
from alembic import op

revision = "9998"
down_revision = "{before}"
branch_labels = depends_on = None


def upgrade():
    op.add_column("robots", sa.Column("note", sa.String(10), server_default="old"))
{then}"""


@pytest.fixture
def add_migration(tmp_path, monkeypatch):
    """Let RTron have one more migration than the database, which ends with some lines."""
    folder = tmp_path / "migrations"
    shutil.copytree(schema_migration._SCRIPT_FOLDER, folder)

    def add(then=""):
        (folder / "versions/r9998_next.py").write_text(NEXT.format(before=head, then=then))

    head = head_revision()
    monkeypatch.setattr(schema_migration, "_SCRIPT_FOLDER", folder)
    schema_migration._scripts.cache_clear()
    yield add
    schema_migration._scripts.cache_clear()


def columns_of_robots(database):
    with database.engine.connect() as connection:
        return {column["name"] for column in inspect(connection).get_columns("robots")}


def test_an_older_schema_is_upgraded_with_what_is_in_it(database, where, add_migration):
    with database.session() as session:
        session.execute(text("INSERT INTO robots (name, created) VALUES ('r', 1)"))
    add_migration()
    upgraded = Database(where)
    with upgraded.session() as session:
        assert session.execute(text("SELECT name, note FROM robots")).one() == ("r", "old")
        assert session.scalar(text("SELECT version_num FROM alembic_version")) == "9998"
    upgraded.close()


def test_an_upgrade_that_fails_leaves_the_older_schema(database, where, add_migration):
    add_migration('    raise RuntimeError("killed")\n')
    with pytest.raises(RuntimeError, match="killed"):
        Database(where)
    assert "note" not in columns_of_robots(database)


def test_live_guards_are_unlogged(postgresql):
    database = Database(postgresql.new_database())
    query = "SELECT relname FROM pg_class WHERE relpersistence = 'u' AND relkind = 'r'"
    with database.session() as session:
        assert session.scalars(text(query)).all() == ["live_guards"]
    database.close()


def test_services_that_start_at_once_migrate_in_turn(empty_place):
    failures = []

    def open_it():
        try:
            Database(empty_place).close()
        except Exception as error:  # noqa: BLE001
            failures.append(error)

    threads = [Thread(target=open_it) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []


def test_an_old_postgresql_is_refused(postgresql, monkeypatch):
    monkeypatch.setattr(schema_migration, "MIN_POSTGRESQL", (99,))
    with pytest.raises(InputError, match=r"PostgreSQL \d+ is too old") as raised:
        Database(postgresql.new_database())
    assert "use PostgreSQL 99, or newer" in raised.value.help


@pytest.mark.parametrize(
    ("revision", "help"), [("9999", "newest RTron"), ("0009", "give another --database")]
)
def test_an_unknown_schema_is_refused(database, where, revision, help):
    with database.session() as session:
        session.execute(text(f"UPDATE alembic_version SET version_num = '{revision}'"))
    with pytest.raises(
        InputError, match=f"{revision} is unknown to this RTron, which has {head_revision()}"
    ) as raised:
        Database(where)
    assert raised.value.help.startswith(("start the " if revision == "9999" else "") + help)


def test_tables_of_another_program_are_left_alone(tmp_path):
    path = tmp_path / "other.db"
    with closing(sqlite3.connect(path)) as other:
        other.execute("CREATE TABLE users (name TEXT)")
    with pytest.raises(InputError, match="another program: users"):
        Database(path)
    with closing(sqlite3.connect(path)) as other:
        names = {row[0] for row in other.execute("SELECT name FROM sqlite_master")}
    assert names == {"users"}


def test_a_migration_that_fails_leaves_nothing(tmp_path, monkeypatch):
    path = tmp_path / "rtron.db"
    engine = create_engine(f"sqlite:///{path}")

    def fail(*args, **kwargs):
        raise RuntimeError("killed")

    monkeypatch.setattr("alembic.runtime.migration.HeadMaintainer.update_to_step", fail)
    with pytest.raises(RuntimeError, match="killed"):
        migrate(engine)
    with engine.connect() as connection:
        assert inspect(connection).get_table_names() == []
    monkeypatch.undo()
    migrate(engine)
    engine.dispose()


@pytest.mark.parametrize(
    "content", [b"no database at all, " * 500, b"SQLite format 3\0" + b"x" * 4096]
)
def test_a_file_that_is_no_database(tmp_path, content):
    path = tmp_path / "notes.txt"
    path.write_bytes(content)
    with pytest.raises(InputError, match="not a database") as raised:
        Database(path)
    assert str(path) in str(raised.value)
    assert path.read_bytes() == content


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match="unable to open"):
        Database(tmp_path / "none" / "rtron.db")


@pytest.mark.parametrize(
    ("url", "error"),
    [
        ("postgresql://me:hushhush@127.0.0.1:1/rtron", SourceError),
        ("postgresql://me:hushhush@[::bad/rtron", InputError),
        ("postgresql://me:hushhush@host:port/rtron", InputError),
        ("mysql://me:hushhush@host/rtron", InputError),
    ],
)
def test_a_wrong_url_is_told_without_its_password(url, error):
    with pytest.raises(error) as raised:
        Database(url)
    assert "hushhush" not in f"{raised.value} {raised.value.help}"
