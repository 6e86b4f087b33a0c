"""The objects that the parts of the running service share, and their dependency for requests."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from rtron.service.config import ServiceConfig
from rtron.service.controller.command_dispatcher import (
    CommandDispatcher,
    LeaseDispatcher,
    RequestDispatcher,
)
from rtron.service.controller.risk_controller import RiskController
from rtron.service.domain.clock import Clock, SteadyClock
from rtron.service.domain.signed_documents import DocumentSigner
from rtron.service.live.hub import Hub
from rtron.service.live.live_robots import LiveRobots
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
