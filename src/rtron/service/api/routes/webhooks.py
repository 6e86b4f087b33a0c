"""Webhooks: added and removed by an admin."""

from typing import Annotated, Any
from urllib.parse import urlsplit

from fastapi import APIRouter, Path

from rtron.service.alerts.webhook_url import parse_webhook_url
from rtron.service.api.auth.authorization import AdminOnly
from rtron.service.api.context import ServiceDependency, audit_transaction
from rtron.service.api.schemas import CreatedWebhook, NewWebhook, WebhookView
from rtron.service.domain.schemas import WebhookLevel
from rtron.service.store.tables import WebhookRow
from rtron.service.store.webhooks import add_webhook, all_webhooks, remove_webhook

router = APIRouter(prefix="/webhooks")

Id = Annotated[int, Path(ge=1, le=(1 << 63) - 1)]


@router.get("")
def list_webhooks(_caller: AdminOnly, service: ServiceDependency) -> list[WebhookView]:
    """Return every webhook, and why its last call failed."""
    with service.database.session() as session:
        return [WebhookView(**_view(each)) for each in all_webhooks(session)]


@router.post("", status_code=201)
def create_webhook(
    new: NewWebhook, caller: AdminOnly, service: ServiceDependency
) -> CreatedWebhook:
    """Add a webhook; the secret that signs its calls is told this once."""
    with audit_transaction(
        service, caller.audit_event("add webhook", _url_origin(new.url), level=new.level)
    ) as session:
        parse_webhook_url(new.url)
        row = add_webhook(session, service.clock(), new.url, new.level)
        return CreatedWebhook(**_view(row), secret=row.secret)


@router.delete("/{webhook}", status_code=204)
def delete_webhook(webhook: Id, caller: AdminOnly, service: ServiceDependency) -> None:
    """Remove a webhook."""
    with audit_transaction(service, caller.audit_event("remove webhook", str(webhook))) as session:
        remove_webhook(session, webhook)


def _url_origin(url: str) -> str:
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
        "level": WebhookLevel(row.level),
        "created": row.created,
        "failing": row.failing,
    }
