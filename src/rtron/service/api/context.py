"""What the parts of the running service share, and how a request finds it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

if TYPE_CHECKING:
    from rtron.service.config import Config
    from rtron.service.controller.risk_controller import Controller
    from rtron.service.domain.clock import Clock
    from rtron.service.live.hub import Hub
    from rtron.service.store.database import Database


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """The running service."""

    database: "Database"
    hub: "Hub"
    controller: "Controller"
    clock: "Clock"
    config: "Config"


def service_of(connection: HTTPConnection) -> Service:
    """Return the service that a request, or a WebSocket, has come to."""
    service: Service = connection.app.state.service
    return service


Served = Annotated[Service, Depends(service_of)]
