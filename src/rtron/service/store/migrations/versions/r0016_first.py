"""The first schema that is upgraded. A new database gets its tables from their classes."""

revision = "0016"
down_revision = None
branch_labels = None
depends_on = None
