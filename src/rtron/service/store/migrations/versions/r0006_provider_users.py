"""Users who sign in at an OpenID provider."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the subject, by which the provider knows a user; nobody has one yet."""
    op.add_column("users", sa.Column("subject", sa.String(length=64), nullable=True))
    op.create_index("users_by_subject", "users", ["subject"], unique=True)
