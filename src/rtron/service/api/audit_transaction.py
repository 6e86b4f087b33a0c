"""Changes as the audit log sees them: done, or refused and why."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.orm import Session

from rtron.errors import RTronError
from rtron.service.api.context import Service
from rtron.service.store.audit import Deed, record, record_often


@contextmanager
def audited(service: Service, deed: Deed) -> Iterator[Session]:
    """Give the transaction of a deed; what comes of it is written down, a refusal too."""
    try:
        with service.database.session() as session:
            yield session
            record(session, service.clock(), deed)
    except RTronError as error:
        note_refused(service, deed, str(error))
        raise


def note_refused(service: Service, deed: Deed, why: str) -> None:
    """Write down a deed that was refused."""
    with service.database.session() as session:
        record_often(session, service.clock(), deed, f"refused: {why}")
