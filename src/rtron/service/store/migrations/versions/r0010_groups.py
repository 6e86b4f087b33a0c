"""Labels of robots, and the groups to which users and tokens are limited."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table of labels; users and tokens that there are may change every robot."""
    id_type = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
    op.create_table(
        "robot_labels",
        sa.Column("robot_id", id_type, nullable=False),
        sa.Column("label", sa.String(length=100), nullable=False),
        sa.ForeignKeyConstraint(["robot_id"], ["robots.id"]),
        sa.PrimaryKeyConstraint("robot_id", "label"),
    )
    op.create_index("ix_robot_labels_label", "robot_labels", ["label"])
    for table in ("users", "tokens"):
        op.add_column(table, sa.Column("groups", sa.JSON(none_as_null=True), nullable=True))
