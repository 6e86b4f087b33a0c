"""Acknowledged alarms, and what one shift tells the next."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the tables."""
    _acknowledgements()
    _handovers()


def _id() -> sa.types.TypeEngine[int]:
    return sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def _acknowledgements() -> None:
    op.create_table(
        "acknowledgements",
        sa.Column("id", _id(), nullable=False),
        sa.Column("robot_id", _id(), nullable=False),
        sa.Column("kind", sa.String(length=40), nullable=False),
        sa.Column("topic", sa.String(length=300), nullable=False),
        sa.Column("node", sa.String(length=300), nullable=False),
        sa.Column("peer", sa.String(length=300), nullable=False),
        sa.Column("by", sa.String(length=100), nullable=False),
        sa.Column("note", sa.String(length=200), nullable=False),
        sa.Column("at", sa.BigInteger(), nullable=False),
        sa.Column("ended", sa.BigInteger(), nullable=True),
        sa.ForeignKeyConstraint(["robot_id"], ["robots.id"]),
        sa.PrimaryKeyConstraint("id"),
    )
    in_force = sa.text("ended IS NULL")
    op.create_index(
        "acknowledgements_in_force",
        "acknowledgements",
        ["robot_id"],
        sqlite_where=in_force,
        postgresql_where=in_force,
    )


def _handovers() -> None:
    op.create_table(
        "handovers",
        sa.Column("id", _id(), nullable=False),
        sa.Column("at", sa.BigInteger(), nullable=False),
        sa.Column("by", sa.String(length=100), nullable=False),
        sa.Column("text", sa.String(length=4000), nullable=False),
        sa.Column("situation", sa.JSON(), nullable=False),
        sa.PrimaryKeyConstraint("id"),
    )
