"""The audit log: every change that somebody asked for, and what came of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from rtron.service.store.tables import AuditRow
from rtron.vocabulary import SECOND

_DONE = "done"
_LONGEST = 300
_MOST_ALIKE = 20
_MINUTE = 60 * SECOND


@dataclass(frozen=True, slots=True, kw_only=True)
class Deed:
    """Who wants what done to what, and from where; `detail` never holds a secret."""

    who: str
    action: str
    target: str
    address: str = ""
    detail: Mapping[str, Any] = field(default_factory=dict)


def record(session: Session, at: int, deed: Deed, outcome: str = _DONE) -> None:
    """Write one line at `at` (ns); `outcome` is `done`, or why it was not."""
    row = AuditRow(
        at=at,
        who=deed.who,
        address=deed.address,
        action=deed.action,
        target=deed.target[:_LONGEST],
        detail=dict(deed.detail),
        outcome=outcome[:_LONGEST],
    )
    session.add(row)


def record_often(session: Session, at: int, deed: Deed, outcome: str) -> None:
    """Write what somebody can repeat at will: refusals, a guard's answers, what changes nothing.

    Within a minute the same once more is counted in its line (`count` in the detail), and so is,
    in the newest line, whatever else it is after 20 lines of who does that.
    """
    alike = _alike(session, at, deed, is_done=outcome == _DONE)
    key = _key(deed.target, deed.detail, outcome)
    twin = next((row for row in alike if _key(row.target, row.detail, row.outcome) == key), None)
    if twin is None and len(alike) == _MOST_ALIKE:
        twin = alike[0]
    if twin is None:
        record(session, at, deed, outcome)
    else:
        twin.detail = {**twin.detail, "count": twin.detail.get("count", 1) + 1}


def _alike(session: Session, at: int, deed: Deed, *, is_done: bool) -> Sequence[AuditRow]:
    """Return what the same one did of that kind within a minute before `at`, newest first."""
    query = select(AuditRow).where(
        AuditRow.at > at - _MINUTE,
        AuditRow.who == deed.who,
        AuditRow.action == deed.action,
        AuditRow.outcome == _DONE if is_done else AuditRow.outcome != _DONE,
    )
    return session.scalars(query.order_by(AuditRow.id.desc()).limit(_MOST_ALIKE)).all()


def _key(target: str, detail: Mapping[str, Any], outcome: str) -> tuple[object, ...]:
    return target[:_LONGEST], detail.get("revision"), detail.get("run"), outcome[:_LONGEST]
