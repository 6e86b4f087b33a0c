"""The audit log: every change that was requested, and its outcome."""

from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from rtron.service.domain.audit_events import AuditEvent
from rtron.service.store.tables import AuditRow
from rtron.vocabulary import SECOND

_DONE = "done"
_MAX_LENGTH = 300
_MAX_SIMILAR = 20
_MINUTE = 60 * SECOND


def record_event(session: Session, at: int, event: AuditEvent, outcome: str = _DONE) -> None:
    """Write one line at `at` (ns); `outcome` is `done`, or why it was not."""
    row = AuditRow(
        at=at,
        who=event.who,
        address=event.address,
        action=event.action,
        target=event.target[:_MAX_LENGTH],
        detail=dict(event.detail),
        outcome=outcome[:_MAX_LENGTH],
    )
    session.add(row)


def record_repeatable(session: Session, at: int, event: AuditEvent, outcome: str) -> None:
    """Write what somebody can repeat at will: refusals, a guard's answers, what changes nothing.

    Within a minute the same once more is counted in its line (`count` in the detail), and so is,
    in the newest line, whatever else it is after 20 lines of who does that.
    """
    alike = _recent_similar(session, at, event, is_done=outcome == _DONE)
    key = _duplicate_key(event.target, event.detail, outcome)
    same_row = next(
        (row for row in alike if _duplicate_key(row.target, row.detail, row.outcome) == key), None
    )
    if same_row is None and len(alike) == _MAX_SIMILAR:
        same_row = alike[0]
    if same_row is None:
        record_event(session, at, event, outcome)
    else:
        same_row.detail = {**same_row.detail, "count": same_row.detail.get("count", 1) + 1}


def _recent_similar(
    session: Session, at: int, event: AuditEvent, *, is_done: bool
) -> Sequence[AuditRow]:
    """Return what the same one did of that kind within a minute before `at`, newest first."""
    query = select(AuditRow).where(
        AuditRow.at > at - _MINUTE,
        AuditRow.who == event.who,
        AuditRow.action == event.action,
        AuditRow.outcome == _DONE if is_done else AuditRow.outcome != _DONE,
    )
    return session.scalars(query.order_by(AuditRow.id.desc()).limit(_MAX_SIMILAR)).all()


def _duplicate_key(target: str, detail: Mapping[str, Any], outcome: str) -> tuple[object, ...]:
    return target[:_MAX_LENGTH], detail.get("revision"), detail.get("run"), outcome[:_MAX_LENGTH]
