"""Webhooks: added and removed by an admin."""

from typing import Annotated, Any
from urllib.parse import urlsplit

from fastapi import APIRouter, Path

from rtron.service.alerts.webhook_url import check_url
from rtron.service.api.audit_transaction import audited
from rtron.service.api.auth.authorization import AdminOnly
from rtron.service.api.context import Served
from rtron.service.domain.schemas import CreatedWebhook, NewWebhook, WebhookView
from rtron.service.store.tables import WebhookRow
from rtron.service.store.webhooks import add_webhook, all_webhooks, remove_webhook
from rtron.vocabulary import Level

router = APIRouter(prefix="/webhooks")

Id = Annotated[int, Path(ge=1, le=(1 << 63) - 1)]


@router.get("")
def list_webhooks(_caller: AdminOnly, service: Served) -> list[WebhookView]:
    """Return every webhook, and why its last call failed."""
    with service.database.session() as session:
        return [WebhookView(**_view(each)) for each in all_webhooks(session)]


@router.post("", status_code=201)
def new_webhook(new: NewWebhook, caller: AdminOnly, service: Served) -> CreatedWebhook:
    """Add a webhook; the secret that signs its calls is told this once."""
    with audited(service, caller.deed("add webhook", _place(new.url), level=new.level)) as session:
        check_url(new.url)
        row = add_webhook(session, service.clock(), new.url, new.level)
        return CreatedWebhook(**_view(row), secret=row.secret)


@router.delete("/{webhook}", status_code=204)
def delete_webhook(webhook: Id, caller: AdminOnly, service: Served) -> None:
    """Remove a webhook."""
    with audited(service, caller.deed("remove webhook", str(webhook))) as session:
        remove_webhook(session, webhook)


def _place(url: str) -> str:
    """Return where a URL leads; chat services keep their secret in the path."""
    try:
        parts = urlsplit(url)
        return f"{parts.scheme}://{parts.hostname or ''}"
    except ValueError:
        return ""


def _view(row: WebhookRow) -> dict[str, Any]:
    return {
        "id": row.id,
        "url": row.url,
        "level": Level(row.level),
        "created": row.created,
        "failing": row.failing,
    }
