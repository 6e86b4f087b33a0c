"""PostgreSQL's table of events gets partitions; the events that are there are the first one.

SQLite's stays as it is.
"""

import sqlalchemy as sa
from alembic import op

from rtron.service.store.partitions.event_partitions import (
    ID_BITS,
    id_range,
    make_partition,
    partition_name,
)

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None

_INDEXES = {
    "events_by_robot": "(robot_id, id, at)",
    "events_by_kind": "(robot_id, kind, id)",
    "events_of_note": "(robot_id, id) WHERE level <> 'info'",
    "events_without_counts": "(robot_id, id) WHERE kind <> 'counts'",
    "events_counts": "(robot_id, at) WHERE kind = 'counts'",
}


def upgrade() -> None:
    """Make the table of runs, and the partitioned table."""
    _runs()
    if op.get_bind().dialect.name != "sqlite":
        _partition_events()
        _fill_runs()


def _id() -> sa.types.TypeEngine[int]:
    return sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def _runs() -> None:
    op.create_table(
        "event_runs",
        sa.Column("robot_id", _id(), nullable=False),
        sa.Column("run", sa.String(length=40), nullable=False),
        sa.Column("number", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["robot_id"], ["robots.id"]),
        sa.PrimaryKeyConstraint("robot_id", "run"),
    )


def _partition_events() -> None:
    last = op.get_bind().exec_driver_sql("SELECT last_value FROM events_id_seq").scalar_one()
    number = int(last) >> ID_BITS
    first, (_, end) = partition_name(number), id_range(number)
    op.execute(f"ALTER TABLE events RENAME TO {first}")
    op.execute(f"ALTER TABLE {first} DROP CONSTRAINT events_robot_id_run_number_key")
    for name in ("events_pkey", *_INDEXES):
        op.execute(f"ALTER INDEX {name} RENAME TO {first}{name.removeprefix('events')}")
    op.execute(f"CREATE INDEX {first}_by_number ON {first} (robot_id, run, number)")
    op.execute(f"CREATE TABLE events (LIKE {first} INCLUDING DEFAULTS) PARTITION BY RANGE (id)")
    op.execute("ALTER TABLE events ADD PRIMARY KEY (id)")
    op.execute("ALTER TABLE events ADD FOREIGN KEY (robot_id) REFERENCES robots (id)")
    op.execute("CREATE INDEX events_by_number ON events (robot_id, run, number)")
    for name, columns in _INDEXES.items():
        op.execute(f"CREATE INDEX {name} ON events {columns}")
    op.execute("ALTER SEQUENCE events_id_seq OWNED BY events.id")
    op.execute(f"ALTER TABLE events ATTACH PARTITION {first} FOR VALUES FROM (MINVALUE) TO ({end})")
    make_partition(op.get_bind(), number + 1)


def _fill_runs() -> None:
    op.execute(
        "INSERT INTO event_runs (robot_id, run, number) "
        "SELECT robot_id, run, max(number) FROM events GROUP BY robot_id, run"
    )
