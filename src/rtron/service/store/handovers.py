"""What one shift tells the next; what was written stays."""

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session

from rtron.service.domain.shifts import Handover, Situation
from rtron.service.store.notices import HandoverNotice, post_notice
from rtron.service.store.tables import HandoverRow


def add_handover(session: Session, by: str, text: str, situation: Situation, now: int) -> Handover:
    """Write a note."""
    row = HandoverRow(at=now, by=by, text=text, situation=situation.model_dump())
    session.add(row)
    session.flush()
    post_notice(session, HandoverNotice())
    return _view(row)


def list_handovers(session: Session, before: int | None, limit: int) -> Sequence[Handover]:
    """Return notes, newest first, those older than `before`."""
    query = select(HandoverRow).order_by(HandoverRow.id.desc()).limit(limit)
    if before is not None:
        query = query.where(HandoverRow.id < before)
    return [_view(row) for row in session.scalars(query)]


def _view(row: HandoverRow) -> Handover:
    return Handover.model_validate(row, from_attributes=True)
