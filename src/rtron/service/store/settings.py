"""The settings of an app, revision by revision; what was written stays."""

import hashlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import TypeAdapter
from sqlalchemy import func, select, tuple_, update
from sqlalchemy.orm import Session

from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.hash_chain import canonical_json
from rtron.service.domain.schemas import SettingsOutcome, SettingsView
from rtron.service.store.notices import SettingsNotice, post_notices
from rtron.service.store.tables import AppRow, RobotRow, SettingsRow
from rtron.vocabulary import Settings

_SETTINGS: TypeAdapter[Settings] = TypeAdapter(Settings)
_MAX_LENGTH = 1000
SETTINGS_KEY = "settings"
"""Where the detail of a line of the audit log has which settings came of it."""


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
    return add_all_settings(session, {app_id: settings}, author)[app_id]


def add_all_settings(
    session: Session, settings_by_app: Mapping[int, Settings], author: ChangeAuthor
) -> dict[int, SettingsRow]:
    """Write new settings of several apps; IntegrityError if one has that revision already."""
    rows = {
        app_id: SettingsRow(
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
        for app_id, settings in settings_by_app.items()
    }
    session.add_all(rows.values())
    session.flush()
    return rows


def with_settings(event: AuditEvent, app: AppRow, row: SettingsRow) -> AuditEvent:
    """Return an event of the audit log with which settings came of it, and their digest."""
    made = {"app": app.name, "revision": row.revision, "sha256": settings_digest(app.name, row)}
    return replace(event, detail={**event.detail, SETTINGS_KEY: made})


def settings_digest(app: str, row: SettingsRow) -> str:
    """Return the SHA-256 (hex) of settings, who made them, when and why: what never changes."""
    made = {"app": app, "revision": row.revision, "document": row.document}
    author = {"by": row.by, "reason": row.reason, "at": row.at}
    return hashlib.sha256(canonical_json({**made, **author})).hexdigest()


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


def announce_settings(session: Session, robot: str, row: SettingsRow) -> None:
    """Tell other replicas of settings, or of what a guard said to them, once they are committed."""
    announce_all_settings(session, {robot: row})


def announce_all_settings(session: Session, rows: Mapping[str, SettingsRow]) -> None:
    """Tell other replicas of the settings of several robots, once they are committed."""
    notices = [
        SettingsNotice(robot=robot, app_id=row.app_id, revision=row.revision)
        for robot, row in rows.items()
    ]
    post_notices(session, notices)


def find_views(
    session: Session, keys: Collection[tuple[int, int]]
) -> dict[tuple[int, int], SettingsView]:
    """Return settings by app and revision."""
    key = tuple_(SettingsRow.app_id, SettingsRow.revision)
    rows = session.scalars(select(SettingsRow).where(key.in_(keys)))
    return {(row.app_id, row.revision): settings_view(row) for row in rows}


def newest_settings_by_app(session: Session, app_ids: Collection[int]) -> dict[int, SettingsRow]:
    """Return the newest settings of each of these apps."""
    last = (
        select(SettingsRow.app_id, func.max(SettingsRow.revision).label("revision"))
        .where(SettingsRow.app_id.in_(app_ids))
        .group_by(SettingsRow.app_id)
        .subquery()
    )
    query = select(SettingsRow).join(
        last, (SettingsRow.app_id == last.c.app_id) & (SettingsRow.revision == last.c.revision)
    )
    return {row.app_id: row for row in session.scalars(query)}


def newest_settings_by_robot(session: Session, robots: Collection[str]) -> dict[str, SettingsRow]:
    """Return the newest settings of the current app of each of these robots."""
    query = select(RobotRow.name, RobotRow.app_id).where(RobotRow.name.in_(robots))
    apps = {name: app_id for name, app_id in session.execute(query) if app_id is not None}
    rows = newest_settings_by_app(session, list(apps.values()))
    return {name: rows[app_id] for name, app_id in apps.items() if app_id in rows}


def load_settings(row: SettingsRow) -> Settings:
    """Return the settings of a row."""
    return load_settings_document(row.document)


def load_settings_document(document: Mapping[str, Any]) -> Settings:
    """Return the settings that `settings_json` has written."""
    return _SETTINGS.validate_python(document)


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
