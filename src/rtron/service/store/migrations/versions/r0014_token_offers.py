"""When the next secret of a token was made: for a while nobody else gets another one."""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Next secrets of before may be replaced at any time, as they could."""
    op.add_column("tokens", sa.Column("next_created", sa.BigInteger(), nullable=True))
