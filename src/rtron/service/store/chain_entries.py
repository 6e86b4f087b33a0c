"""The chains as they are stored, read in one state of the database."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sqlalchemy import Row, Select, select
from sqlalchemy.orm import Session

from rtron.service.domain.hash_chain import Link
from rtron.service.store.audit import AUDIT_CONTENT, audit_content
from rtron.service.store.chains import EVENTS_PREFIX
from rtron.service.store.database import Database
from rtron.service.store.event_rows import EVENT_CONTENT, event_content
from rtron.service.store.tables import AuditRow, ChainLinkRow, ChainRow, EventRow, RobotRow

_PAGE = 1000


@contextmanager
def snapshot(database: Database) -> Iterator[Session]:
    """Give a transaction that sees one state of the database, and writes nothing."""
    with Session(database.engine) as session:
        if database.is_sqlite:
            session.connection().exec_driver_sql("BEGIN")
        else:
            session.connection(execution_options={"isolation_level": "REPEATABLE READ"})
        yield session


def all_chains(session: Session) -> list[ChainRow]:
    """Return every chain, by name."""
    return list(session.scalars(select(ChainRow).order_by(ChainRow.name)))


def chain_links(
    session: Session, chain: ChainRow, after: int | None = None, end_id: int | None = None
) -> Iterator[Link]:
    """Yield the entries of a chain in their order, all of them unless told otherwise.

    Those behind a number, and of rows before an id.
    """
    query = _events_query() if chain.name.startswith(EVENTS_PREFIX) else _audit_query()
    query = query.where(ChainLinkRow.chain_id == chain.id).order_by(ChainLinkRow.number)
    if end_id is not None:
        query = query.where(ChainLinkRow.entry_id < end_id)
    if after is not None:
        query = query.where(ChainLinkRow.number > after)
    page = query.limit(_PAGE)
    while rows := session.execute(page).all():
        yield from (_link(row) for row in rows)
        page = query.where(ChainLinkRow.number > rows[-1].link_number).limit(_PAGE)


def _audit_query() -> Select[Any]:
    columns = [getattr(AuditRow, name) for name in AUDIT_CONTENT]
    return select(*_link_columns(AuditRow.id), *columns).outerjoin(
        AuditRow, AuditRow.id == ChainLinkRow.entry_id
    )


def _events_query() -> Select[Any]:
    columns = [getattr(EventRow, name) for name in EVENT_CONTENT]
    return (
        select(*_link_columns(EventRow.id), RobotRow.name.label("robot"), *columns)
        .outerjoin(EventRow, EventRow.id == ChainLinkRow.entry_id)
        .outerjoin(RobotRow, RobotRow.id == EventRow.robot_id)
    )


def _link_columns(entry_id: Any) -> list[Any]:  # noqa: ANN401 - a column
    link = ChainLinkRow
    return [link.number.label("link_number"), link.hash.label("link_hash"), entry_id.label("found")]


def _link(row: Row[Any]) -> Link:
    if row.found is None:
        return Link(row.link_number, row.link_hash, None)
    is_event = "robot" in row._fields
    content = event_content(row.robot, row._asdict()) if is_event else audit_content(row)
    return Link(row.link_number, row.link_hash, content)
