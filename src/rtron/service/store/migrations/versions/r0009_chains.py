"""Hash chains of the audit log and of events; the lines that are there begin the service's chain.

Events that are there stay outside: retention deletes them.
"""

import sqlalchemy as sa
from alembic import op
from sqlalchemy.orm import Session

from rtron.service.store.audit import AUDIT_CONTENT, audit_content
from rtron.service.store.chains import SERVICE_CHAIN, ChainEntry, append_entries
from rtron.service.store.tables import AuditRow

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None

_PAGE = 1000


def upgrade() -> None:
    """Make the tables, and link what is there."""
    _chains()
    _links()
    with Session(op.get_bind()) as session:
        _link_old_lines(session)
        session.commit()


def _id() -> sa.types.TypeEngine[int]:
    return sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def _chains() -> None:
    op.create_table(
        "chains",
        sa.Column("id", _id(), nullable=False),
        sa.Column("name", sa.String(length=120), nullable=False),
        sa.Column("number", sa.BigInteger(), nullable=False),
        sa.Column("hash", sa.String(length=64), nullable=False),
        sa.Column("anchor", sa.JSON(), nullable=True),
        sa.PrimaryKeyConstraint("id"),
        sa.UniqueConstraint("name"),
    )


def _links() -> None:
    op.create_table(
        "chain_links",
        sa.Column("chain_id", _id(), nullable=False),
        sa.Column("number", sa.BigInteger(), nullable=False),
        sa.Column("hash", sa.String(length=64), nullable=False),
        sa.Column("entry_id", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["chain_id"], ["chains.id"]),
        sa.PrimaryKeyConstraint("chain_id", "number"),
        sqlite_with_rowid=False,
    )
    op.create_index("ix_chain_links_entry_id", "chain_links", ["entry_id"])


def _link_old_lines(session: Session) -> None:
    columns = [AuditRow.id, *(getattr(AuditRow, name) for name in AUDIT_CONTENT)]
    query = sa.select(*columns).order_by(AuditRow.id).limit(_PAGE)
    rows = session.execute(query).all()
    while rows:
        entries = [ChainEntry(SERVICE_CHAIN, row.id, audit_content(row)) for row in rows]
        append_entries(session, entries)
        rows = session.execute(query.where(AuditRow.id > rows[-1].id)).all()
