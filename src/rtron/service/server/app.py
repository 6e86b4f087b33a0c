"""The security service as one ASGI app: the HTTP API, the guards' link and the console."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import APIRouter, FastAPI
from prometheus_client import CollectorRegistry
from starlette.middleware import Middleware

from rtron import __version__
from rtron.service.alerts.dispatcher import AlertDispatcher
from rtron.service.api.context import ServiceContext
from rtron.service.api.error_responses import ERROR_RESPONSES, install_error_handlers
from rtron.service.api.middleware.request_body import RequestBodyLimit
from rtron.service.api.middleware.request_checks import HostCheck, NulCheck, OriginCheck
from rtron.service.api.middleware.responses import InternalErrorHandler, SecurityHeaders
from rtron.service.api.routes import (
    audit,
    events,
    graphs,
    live,
    logins,
    monitoring,
    robots,
    tokens,
    users,
    webhooks,
)
from rtron.service.api.routes.monitoring import ServiceMetrics
from rtron.service.collector import websocket_endpoint
from rtron.service.collector.data_collector import DataCollector
from rtron.service.config import ServiceConfig
from rtron.service.console import routes as console
from rtron.service.controller.risk_controller import RiskController
from rtron.service.domain.clock import Clock, wall_clock
from rtron.service.domain.login_throttle import LoginThrottle
from rtron.service.live.hub import Hub
from rtron.service.server.database_setup import open_database
from rtron.service.store.accounts.last_use import record_use
from rtron.service.store.accounts.tokens import find_guard_token

API = "/api/v1"
_API_ROUTES = (logins, robots, graphs, events, audit, users, tokens, webhooks, live)


def create_app(config: ServiceConfig, clock: Clock = wall_clock) -> FastAPI:
    """Return the service on its database, which is opened here; InputError if that fails."""
    service = create_service(config, clock)
    app = FastAPI(
        title="RTron security service",
        version=__version__,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        middleware=_middleware(config),
        lifespan=_lifespan,
    )
    app.state.service = service
    app.state.login_throttle = LoginThrottle()
    app.state.sockets = set()
    app.state.collector = _data_collector(service)
    app.state.registry = CollectorRegistry(auto_describe=False)
    counters = app.state.collector.counters
    app.state.registry.register(ServiceMetrics(service, counters, app.state.login_throttle))
    install_error_handlers(app)
    _include(app)
    return app


def create_service(config: ServiceConfig, clock: Clock = wall_clock) -> ServiceContext:
    """Return the parts of the service."""
    database, hub = open_database(config.database), Hub()
    controller = RiskController(database, hub, clock)
    return ServiceContext(
        database=database, hub=hub, controller=controller, clock=clock, config=config
    )


def _data_collector(service: ServiceContext) -> DataCollector:
    def authenticate(secret: str) -> str | None:
        now = service.clock()
        with service.database.session() as session:
            token = find_guard_token(session, now, secret)
        if token is None:
            return None
        record_use(service.database, token, now)
        return token.robot

    return DataCollector(
        database=service.database,
        hub=service.hub,
        handshake=service.controller,
        authenticate=authenticate,
        clock=service.clock,
        retention=service.config.retention,
    )


def _include(app: FastAPI) -> None:
    api = APIRouter(prefix=API, responses=ERROR_RESPONSES)
    for part in _API_ROUTES:
        api.include_router(part.router)
    app.include_router(api)
    app.include_router(monitoring.router, responses=ERROR_RESPONSES)
    app.include_router(websocket_endpoint.router)
    app.include_router(console.router)


def _middleware(config: ServiceConfig) -> list[Middleware]:
    """Return what each request goes through, the outermost first."""
    schemes = frozenset({"https"} if config.tls else {"http", "https"})
    return [
        Middleware(SecurityHeaders, is_tls=config.is_secure),
        Middleware(InternalErrorHandler),
        Middleware(HostCheck, names=config.host_names),
        Middleware(OriginCheck, schemes=schemes),
        Middleware(NulCheck),
        Middleware(RequestBodyLimit),
    ]


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    service: ServiceContext = app.state.service
    alerts = AlertDispatcher(service.database, service.hub, service.clock)
    try:
        async with app.state.collector.running(), alerts.running():
            yield
    finally:
        service.database.close()
