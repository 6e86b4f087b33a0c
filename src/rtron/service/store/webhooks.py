"""Webhooks: where alerts go. Their secrets sign, so they are kept as they are."""

from collections.abc import Sequence

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.schemas import WebhookLevel
from rtron.service.store.accounts.random_secrets import new_secret
from rtron.service.store.tables import WebhookRow

_MAX_WEBHOOKS = 20
_MAX_REASON = 300


def all_webhooks(session: Session) -> Sequence[WebhookRow]:
    """Return every webhook, the oldest first."""
    return session.scalars(select(WebhookRow).order_by(WebhookRow.id)).all()


def add_webhook(session: Session, now: int, url: str, level: WebhookLevel) -> WebhookRow:
    """Add a webhook with a secret of its own; ConflictError if there are too many."""
    if len(all_webhooks(session)) >= _MAX_WEBHOOKS:
        raise ConflictError(f"there are {_MAX_WEBHOOKS} webhooks, no more are served")
    row = WebhookRow(url=url, level=str(level), secret=new_secret(), created=now, failing="")
    session.add(row)
    session.flush()
    return row


def remove_webhook(session: Session, id: int) -> WebhookRow:
    """Remove a webhook; NotFoundError if there is none."""
    row = session.get(WebhookRow, id)
    if row is None:
        raise NotFoundError(f"there is no webhook {id}")
    session.delete(row)
    return row


def store_failure(session: Session, id: int, reason: str) -> None:
    """Note why the last call failed, "" if it did not."""
    query = update(WebhookRow).where(WebhookRow.id == id)
    session.execute(query.values(failing=reason[:_MAX_REASON]))
