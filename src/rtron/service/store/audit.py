"""The audit log: every change that somebody asked for, and what came of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sqlalchemy.orm import Session

from rtron.service.store.tables import AuditRow

_LONGEST = 300


@dataclass(frozen=True, slots=True, kw_only=True)
class Deed:
    """Who wants what done to what, and from where; `detail` never holds a secret."""

    who: str
    action: str
    target: str
    address: str = ""
    detail: Mapping[str, Any] = field(default_factory=dict)


def record(session: Session, at: int, deed: Deed, outcome: str = "done") -> None:
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
