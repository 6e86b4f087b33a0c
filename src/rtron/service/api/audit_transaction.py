"""Changes as the audit log sees them: done, or refused and why."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.orm import Session

from rtron.errors import RTronError
from rtron.service.api.context import ServiceContext
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.store.audit import DONE, record_event, record_repeatable


@contextmanager
def audit_transaction(
    service: ServiceContext, event: AuditEvent, *, is_repeatable: bool = False
) -> Iterator[Session]:
    """Give the transaction of a deed; what comes of it is written down, a refusal too.

    What somebody can repeat at will is counted in one line.
    """
    record = record_repeatable if is_repeatable else record_event
    try:
        with service.database.session() as session:
            yield session
            record(session, service.clock(), event, DONE)
    except RTronError as error:
        record_refusal(service, event, str(error))
        raise


def record_refusal(service: ServiceContext, event: AuditEvent, reason: str) -> None:
    """Write down a deed that was refused."""
    with service.database.session() as session:
        record_repeatable(session, service.clock(), event, f"refused: {reason}")
