"""The objects that the parts of the running service share, and their dependency for requests."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends
from sqlalchemy.orm import Session
from starlette.requests import HTTPConnection

from rtron.errors import RTronError
from rtron.service.config import ServiceConfig
from rtron.service.controller.command_dispatcher import (
    CommandDispatcher,
    LeaseDispatcher,
    RequestDispatcher,
)
from rtron.service.controller.risk_controller import RiskController
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock, SteadyClock
from rtron.service.domain.hash_chain import DocumentSigner
from rtron.service.live.hub import Hub
from rtron.service.live.live_robots import LiveRobots
from rtron.service.store.audit import DONE, record_event, record_repeatable
from rtron.service.store.database import Database

_STOP_THREADS = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceContext:
    """The running service; `hub` has what is live here, `live` that of all replicas.

    `stop_threads` do emergency stops only, whatever waits elsewhere. `clock` says when something
    was done. Throttles wait by the `monotonic` one, and what ends at a time that was said before by
    the `steady_clock`.
    """

    database: Database
    hub: Hub
    live: LiveRobots
    controller: RiskController
    dispatcher: CommandDispatcher
    leases: LeaseDispatcher
    requests: RequestDispatcher
    clock: Clock
    monotonic: Clock
    steady_clock: SteadyClock
    config: ServiceConfig
    signer: DocumentSigner
    stop_threads: ThreadPoolExecutor = field(
        default_factory=lambda: ThreadPoolExecutor(_STOP_THREADS, "stop")
    )


def service_context(connection: HTTPConnection) -> ServiceContext:
    """Return the service that a request, or a WebSocket, has come to."""
    service: ServiceContext = connection.app.state.service
    return service


async def _service_context(connection: HTTPConnection) -> ServiceContext:
    """Give the service without a thread, which `Depends` takes for what is no coroutine."""
    return service_context(connection)


ServiceDependency = Annotated[ServiceContext, Depends(_service_context)]


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
