"""Changes as the audit log sees them: done, or refused and why."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.orm import Session

from rtron.errors import RTronError
from rtron.service.api.context import ServiceContext
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.store.audit import record_event, record_repeatable


@contextmanager
def audit_transaction(service: ServiceContext, event: AuditEvent) -> Iterator[Session]:
    """Give the transaction of a deed; what comes of it is written down, a refusal too."""
    try:
        with service.database.session() as session:
            yield session
            record_event(session, service.clock(), event)
    except RTronError as error:
        record_refusal(service, event, str(error))
        raise


def record_refusal(service: ServiceContext, event: AuditEvent, reason: str) -> None:
    """Write down a deed that was refused."""
    with service.database.session() as session:
        record_repeatable(session, service.clock(), event, f"refused: {reason}")
