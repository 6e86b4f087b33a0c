"""Incidents that robots have reported."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table; nothing was reported yet."""
    id_type = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
    op.create_table(
        "incidents",
        sa.Column("id", id_type, nullable=False),
        sa.Column("robot_id", id_type, nullable=False),
        sa.Column("name", sa.String(length=130), nullable=False),
        sa.Column("stored", sa.BigInteger(), nullable=False),
        sa.Column("bytes", sa.BigInteger(), nullable=False),
        sa.Column("summary", sa.JSON(), nullable=False),
        sa.Column("report", sa.JSON(), nullable=False),
        sa.ForeignKeyConstraint(["robot_id"], ["robots.id"]),
        sa.PrimaryKeyConstraint("id"),
        sa.UniqueConstraint("robot_id", "name"),
    )
    op.create_index("incidents_by_robot", "incidents", ["robot_id", "id"])
    op.create_index("incidents_by_stored", "incidents", ["stored"])
