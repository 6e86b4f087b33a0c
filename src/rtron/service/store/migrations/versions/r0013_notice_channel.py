"""A secret name for the channel of notices between replicas."""

from secrets import token_hex

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table, and a name that nobody guesses."""
    name = sa.Column("name", sa.String(length=63), nullable=False)
    table = op.create_table("notice_channel", name, sa.PrimaryKeyConstraint("name"))
    op.bulk_insert(table, [{"name": f"rtron_{token_hex(16)}"}])
