"""Which guards are connected to which replica."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table, which PostgreSQL need not keep over a crash."""
    is_sqlite = op.get_bind().dialect.name == "sqlite"
    op.create_table(
        "live_guards",
        sa.Column("robot", sa.String(length=100), nullable=False),
        sa.Column("replica", sa.BigInteger(), nullable=False),
        sa.Column("version", sa.BigInteger(), nullable=False),
        sa.Column("dry_run", sa.Boolean(), nullable=False),
        sa.Column("state", sa.Text(), nullable=True),
        sa.PrimaryKeyConstraint("robot"),
        prefixes=[] if is_sqlite else ["UNLOGGED"],
    )
