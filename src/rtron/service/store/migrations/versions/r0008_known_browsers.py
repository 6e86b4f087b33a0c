"""Browsers in which users have logged in before."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the table; no browser is known yet."""
    id = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
    op.create_table(
        "known_browsers",
        sa.Column("digest", sa.String(length=64), nullable=False),
        sa.Column("user_id", id, nullable=False),
        sa.Column("created", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["user_id"], ["users.id"]),
        sa.PrimaryKeyConstraint("digest"),
    )
    op.create_index("ix_known_browsers_user_id", "known_browsers", ["user_id"])
