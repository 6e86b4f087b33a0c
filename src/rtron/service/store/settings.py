"""The settings of an app, revision by revision; what was written stays."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter
from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from rtron.service.domain.schemas import SettingsOutcome, SettingsView
from rtron.service.store.tables import SettingsRow
from rtron.vocabulary import Settings

_SETTINGS: TypeAdapter[Settings] = TypeAdapter(Settings)
_MAX_LENGTH = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeAuthor:
    """Who makes settings, why, and when (ns)."""

    by: str
    reason: str
    at: int


def newest_settings(session: Session, app_id: int) -> SettingsRow | None:
    """Return the newest settings of an app."""
    query = select(SettingsRow).where(SettingsRow.app_id == app_id)
    return session.scalars(query.order_by(SettingsRow.revision.desc()).limit(1)).one_or_none()


def find_revision(session: Session, app_id: int, number: int) -> SettingsRow | None:
    """Return the settings of an app at a revision."""
    return session.get(SettingsRow, (app_id, number))


def last_applied_settings(session: Session, app_id: int) -> SettingsRow | None:
    """Return the newest settings that the guard has put in force."""
    query = select(SettingsRow).where(
        SettingsRow.app_id == app_id, SettingsRow.outcome == SettingsOutcome.APPLIED
    )
    return session.scalars(query.order_by(SettingsRow.revision.desc()).limit(1)).one_or_none()


def list_settings(
    session: Session, app_id: int, before: int | None, limit: int
) -> Sequence[SettingsRow]:
    """Return settings, newest first, those older than revision `before`."""
    query = select(SettingsRow).where(SettingsRow.app_id == app_id)
    if before is not None:
        query = query.where(SettingsRow.revision < before)
    return session.scalars(query.order_by(SettingsRow.revision.desc()).limit(limit)).all()


def add_settings(
    session: Session, app_id: int, settings: Settings, author: ChangeAuthor
) -> SettingsRow:
    """Write new settings; IntegrityError if the app has that revision already."""
    row = SettingsRow(
        app_id=app_id,
        revision=settings.revision,
        document=settings_json(settings),
        by=author.by,
        reason=author.reason[:_MAX_LENGTH],
        at=author.at,
        outcome=SettingsOutcome.PENDING,
        error="",
        answered=None,
    )
    session.add(row)
    session.flush()
    return row


def record_answer(
    session: Session, row: SettingsRow, outcome: SettingsOutcome, error: str, now: int
) -> bool:
    """Store the guard's answer and mark older pending revisions as replaced.

    Return whether the answer is new.
    """
    if (row.outcome, row.error) == (outcome, error[:_MAX_LENGTH]):
        return False
    row.outcome, row.error, row.answered = outcome, error[:_MAX_LENGTH], now
    session.execute(
        update(SettingsRow)
        .where(
            SettingsRow.app_id == row.app_id,
            SettingsRow.revision < row.revision,
            SettingsRow.outcome == SettingsOutcome.PENDING,
        )
        .values(outcome=SettingsOutcome.REPLACED, answered=now)
    )
    session.flush()
    return True


def newest_settings_by_app(session: Session) -> dict[int, SettingsRow]:
    """Return the newest settings of every app."""
    last = (
        select(SettingsRow.app_id, func.max(SettingsRow.revision).label("revision"))
        .group_by(SettingsRow.app_id)
        .subquery()
    )
    query = select(SettingsRow).join(
        last,
        (SettingsRow.app_id == last.c.app_id) & (SettingsRow.revision == last.c.revision),
    )
    return {row.app_id: row for row in session.scalars(query)}


def load_settings(row: SettingsRow) -> Settings:
    """Return the settings of a row."""
    return _SETTINGS.validate_python(row.document)


def settings_json(settings: Settings) -> dict[str, Any]:
    """Return settings as JSON."""
    document: dict[str, Any] = _SETTINGS.dump_python(settings, mode="json")
    return document


def settings_view(row: SettingsRow) -> SettingsView:
    """Return settings as the API shows them."""
    return SettingsView(
        revision=row.revision,
        settings=load_settings(row),
        by=row.by,
        reason=row.reason,
        at=row.at,
        outcome=SettingsOutcome(row.outcome),
        error=row.error,
        answered=row.answered,
    )
