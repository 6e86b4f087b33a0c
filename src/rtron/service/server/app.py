"""The security service as one ASGI app: the HTTP API, the guards' link and the console."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import APIRouter, FastAPI
from prometheus_client import CollectorRegistry
from starlette.middleware import Middleware

from rtron import __version__
from rtron.service.alerts.dispatcher import Alerts
from rtron.service.api.context import Service
from rtron.service.api.error_responses import PROBLEMS, handle_problems
from rtron.service.api.middleware.failures import Failures
from rtron.service.api.middleware.hosts import Hosts
from rtron.service.api.middleware.nuls import Nuls
from rtron.service.api.middleware.request_body import Bodies
from rtron.service.api.middleware.request_checks import Origins
from rtron.service.api.middleware.responses import SecurityHeaders
from rtron.service.api.routes import (
    audit,
    events,
    graphs,
    health,
    live,
    logins,
    monitoring,
    robots,
    tokens,
    users,
    webhooks,
)
from rtron.service.api.routes.monitoring import ServiceFigures
from rtron.service.collector import websocket_endpoint
from rtron.service.collector.data_collector import Collector
from rtron.service.config import Config
from rtron.service.console import routes as console
from rtron.service.controller.risk_controller import Controller
from rtron.service.domain.clock import Clock, wall
from rtron.service.domain.login_throttle import Attempts
from rtron.service.live.hub import Hub
from rtron.service.server.database_setup import open_database
from rtron.service.store.accounts.last_use import note_use
from rtron.service.store.accounts.tokens import find_guard

API = "/api/v1"
_OF_API = (logins, robots, graphs, events, audit, users, tokens, webhooks, live)


def create_app(config: Config, clock: Clock = wall) -> FastAPI:
    """Return the service on its database, which is opened here; InputError if that fails."""
    service = create_service(config, clock)
    app = FastAPI(
        title="RTron security service",
        version=__version__,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        middleware=_gates(config),
        lifespan=_running,
    )
    app.state.service = service
    app.state.attempts = Attempts()
    app.state.sockets = set()
    app.state.collector = _collector(service)
    app.state.registry = CollectorRegistry(auto_describe=False)
    figures = ServiceFigures(service, app.state.collector.tally, app.state.attempts)
    app.state.registry.register(figures)
    handle_problems(app)
    _include(app)
    return app


def create_service(config: Config, clock: Clock = wall) -> Service:
    """Return the parts of the service."""
    database, hub = open_database(config.database), Hub()
    controller = Controller(database, hub, clock)
    return Service(database=database, hub=hub, controller=controller, clock=clock, config=config)


def _collector(service: Service) -> Collector:
    def authenticate(secret: str) -> str | None:
        now = service.clock()
        with service.database.session() as session:
            token = find_guard(session, now, secret)
        if token is None:
            return None
        note_use(service.database, token, now)
        return token.robot

    return Collector(
        database=service.database,
        hub=service.hub,
        greeting=service.controller,
        authenticate=authenticate,
        clock=service.clock,
        bounds=service.config.retention,
    )


def _include(app: FastAPI) -> None:
    api = APIRouter(prefix=API, responses=PROBLEMS)
    for part in _OF_API:
        api.include_router(part.router)
    app.include_router(api)
    for outside in (health, monitoring):
        app.include_router(outside.router, responses=PROBLEMS)
    app.include_router(websocket_endpoint.router)
    app.include_router(console.router)


def _gates(config: Config) -> list[Middleware]:
    """Return what each request goes through, the outermost first."""
    schemes = frozenset({"https"} if config.tls else {"http", "https"})
    return [
        Middleware(SecurityHeaders, is_tls=config.is_secure),
        Middleware(Failures),
        Middleware(Hosts, names=config.names),
        Middleware(Origins, schemes=schemes),
        Middleware(Nuls),
        Middleware(Bodies),
    ]


@asynccontextmanager
async def _running(app: FastAPI) -> AsyncIterator[None]:
    service: Service = app.state.service
    alerts = Alerts(service.database, service.hub, service.clock)
    try:
        async with app.state.collector.running(), alerts.running():
            yield
    finally:
        service.database.close()
