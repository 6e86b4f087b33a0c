"""Tokens last for a time, and get a new secret before it is over."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Tokens that have no end keep none; others last as long again when they are renewed."""
    op.add_column("tokens", sa.Column("lifetime", sa.BigInteger(), nullable=True))
    op.add_column("tokens", sa.Column("next_digest", sa.String(length=64), nullable=True))
    op.add_column("tokens", sa.Column("previous_digest", sa.String(length=64), nullable=True))
    op.create_index("tokens_by_next_digest", "tokens", ["next_digest"], unique=True)
    op.create_index("tokens_by_previous_digest", "tokens", ["previous_digest"], unique=True)
    op.execute("UPDATE tokens SET lifetime = expires - created")
