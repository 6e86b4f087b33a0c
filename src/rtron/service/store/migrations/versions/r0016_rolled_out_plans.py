"""Plans that roll-outs bring to robots."""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table of documents; the roll-outs until now change settings."""
    op.create_table(
        "plan_documents",
        sa.Column("digest", sa.String(length=64), nullable=False),
        sa.Column("text", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("digest"),
    )
    op.add_column("rollouts", sa.Column("plan", sa.String(length=64), nullable=True))
