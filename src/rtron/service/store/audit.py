"""The audit log: every change that was requested, and its outcome; each line is in a hash chain."""

from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import Row, select
from sqlalchemy.orm import Session

from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.hash_chain import Content
from rtron.service.store.chains import ChainEntry, append_entries, audit_chain
from rtron.service.store.tables import AuditRow
from rtron.vocabulary import SECOND

AUDIT_CONTENT = ("at", "who", "address", "action", "target", "detail", "outcome")
"""The columns of a line that are in its chain."""
DONE = "done"
_MAX_LENGTH = 300
_MAX_WHO = 100
"""A robot's name may be that long, and its guard is called `guard:NAME`."""
_MAX_SIMILAR = 20
_MAX_LOGINS = 10_000
_MINUTE = 60 * SECOND


def record_event(session: Session, at: int, event: AuditEvent, outcome: str = DONE) -> None:
    """Write one line at `at` (ns); `outcome` is `done`, or why it was not."""
    record_events(session, at, [event], outcome)


def record_events(
    session: Session, at: int, events: Sequence[AuditEvent], outcome: str = DONE
) -> None:
    """Write a line for each event, in this order."""
    rows = [_audit_row(at, event, outcome) for event in events]
    session.add_all(rows)
    session.flush()
    pairs = zip(events, rows, strict=True)
    entries = [ChainEntry(audit_chain(e.robot), row.id, audit_content(row)) for e, row in pairs]
    append_entries(session, entries)


def _audit_row(at: int, event: AuditEvent, outcome: str) -> AuditRow:
    return AuditRow(
        at=at,
        who=event.who[:_MAX_WHO],
        address=event.address,
        action=event.action,
        target=event.target[:_MAX_LENGTH],
        detail=dict(event.detail),
        outcome=outcome[:_MAX_LENGTH],
    )


def audit_content(row: AuditRow | Row[Any]) -> Content:
    """Return what the chain has of a line: all but how often it was counted, which goes on."""
    content = {name: getattr(row, name) for name in AUDIT_CONTENT}
    return {**content, "detail": {key: row.detail[key] for key in row.detail if key != "count"}}


def record_repeatable(session: Session, at: int, event: AuditEvent, outcome: str) -> None:
    """Write what somebody can repeat at will: refusals, a guard's answers, what changes nothing.

    Within a minute the same once more is counted in its line (`count` in the detail), and so is,
    in the newest line, whatever else it is after 20 lines of who does that.
    """
    alike = _recent_similar(session, at, event, is_done=outcome == DONE)
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


def known_logins(session: Session) -> Sequence[tuple[str, str]]:
    """Return users with addresses from which they have logged in, those of the newest logins."""
    query = select(AuditRow.who, AuditRow.address).where(
        AuditRow.action == "login", AuditRow.outcome == DONE
    )
    rows = session.execute(query.order_by(AuditRow.id.desc()).limit(_MAX_LOGINS))
    return [(who, address) for who, address in rows]


def _recent_similar(
    session: Session, at: int, event: AuditEvent, *, is_done: bool
) -> Sequence[AuditRow]:
    """Return what the same one did of that kind within a minute before `at`, newest first."""
    query = select(AuditRow).where(
        AuditRow.at > at - _MINUTE,
        AuditRow.who == event.who[:_MAX_WHO],
        AuditRow.action == event.action,
        AuditRow.outcome == DONE if is_done else AuditRow.outcome != DONE,
    )
    return session.scalars(query.order_by(AuditRow.id.desc()).limit(_MAX_SIMILAR)).all()


def _duplicate_key(target: str, detail: Mapping[str, Any], outcome: str) -> tuple[object, ...]:
    return target[:_MAX_LENGTH], detail.get("revision"), detail.get("run"), outcome[:_MAX_LENGTH]
