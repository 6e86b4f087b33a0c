"""The objects that the parts of the running service share, and their dependency for requests."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from rtron.service.config import ServiceConfig
from rtron.service.controller.risk_controller import RiskController
from rtron.service.domain.clock import Clock
from rtron.service.live.hub import Hub
from rtron.service.store.database import Database


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceContext:
    """The running service."""

    database: Database
    hub: Hub
    controller: RiskController
    clock: Clock
    config: ServiceConfig


def service_context(connection: HTTPConnection) -> ServiceContext:
    """Return the service that a request, or a WebSocket, has come to."""
    service: ServiceContext = connection.app.state.service
    return service


ServiceDependency = Annotated[ServiceContext, Depends(service_context)]
