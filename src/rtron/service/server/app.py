"""The security service as one ASGI app: the HTTP API, the guards' link and the console."""

from collections.abc import AsyncIterator
from contextlib import ExitStack, asynccontextmanager, nullcontext

from fastapi import APIRouter, FastAPI
from prometheus_client import CollectorRegistry
from starlette.middleware import Middleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.routing import BaseRoute

from rtron import __version__
from rtron.service.alerts.dispatcher import AlertDispatcher
from rtron.service.api.auth.login_attempts import LoginQueue
from rtron.service.api.context import ServiceContext
from rtron.service.api.error_responses import ERROR_RESPONSES, install_error_handlers
from rtron.service.api.middleware.request_body import RequestBodyLimit
from rtron.service.api.middleware.request_checks import HostCheck, NulCheck, OriginCheck
from rtron.service.api.middleware.response_middleware import InternalErrorHandler, SecurityHeaders
from rtron.service.api.routes import (
    approvals,
    audit,
    events,
    exports,
    graphs,
    groups,
    live,
    logins,
    monitoring,
    oidc,
    robots,
    rollouts,
    second_factor,
    shifts,
    tokens,
    users,
    webhooks,
)
from rtron.service.api.routes.monitoring import ServiceMetrics, WriteCheck
from rtron.service.api.routes.oidc import OidcSignIn
from rtron.service.collector import websocket_endpoint
from rtron.service.collector.data_collector import DataCollector
from rtron.service.collector.guard_certificates import GuardCertificates
from rtron.service.collector.token_renewal import TokenRenewal
from rtron.service.config import ServiceConfig
from rtron.service.console import routes as console
from rtron.service.controller.command_dispatcher import (
    CommandDispatcher,
    LeaseDispatcher,
    RequestDispatcher,
)
from rtron.service.controller.risk_controller import RiskController
from rtron.service.domain.clock import Clock, SteadyClock, monotonic_clock, wall_clock
from rtron.service.domain.code_throttle import CodeThrottle
from rtron.service.domain.login_throttle import LoginThrottle
from rtron.service.live.hub import Hub
from rtron.service.live.live_robots import LocalLiveRobots, SharedLiveRobots
from rtron.service.replicas.replica import Replica
from rtron.service.replicas.shared_throttles import SharedThrottles
from rtron.service.rollouts.changes import RobotChanges
from rtron.service.rollouts.runner import RolloutRunner
from rtron.service.server.audit_key import load_signer
from rtron.service.server.database_setup import open_database
from rtron.service.server.heads_journal import HeadPublisher, HeadsJournal
from rtron.service.server.oidc_setup import read_client_secret
from rtron.service.store.accounts.tokens import GuardTokens
from rtron.service.store.audit import known_logins
from rtron.service.store.database import Database

API = "/api/v1"
_MIN_COMPRESSED_BYTES = 2048
_GZIP_LEVEL = 4
_RENEWAL_INTERVAL_S = 60.0
_API_ROUTES = (
    logins,
    oidc,
    second_factor,
    robots,
    groups,
    rollouts,
    shifts,
    graphs,
    events,
    exports,
    audit,
    users,
    tokens,
    webhooks,
    approvals,
    live,
)


def create_app(
    config: ServiceConfig, clock: Clock = wall_clock, monotonic: Clock = monotonic_clock
) -> FastAPI:
    """Return the service on its database, which is opened here; InputError if that fails."""
    with ExitStack() as undone:
        database = open_database(config.database)
        undone.callback(database.close)
        app = _assemble(_service(config, database, clock, monotonic))
        undone.pop_all()
    return app


def _assemble(service: ServiceContext) -> FastAPI:
    config = service.config
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
    shared = _shared_throttles(service)
    app.state.login_throttle = _with_known_logins(service, shared.logins if shared else None)
    app.state.login_queue = LoginQueue()
    app.state.code_throttle = shared.codes if shared else CodeThrottle()
    app.state.oidc = _oidc_sign_in(config)
    app.state.sockets = {}
    app.state.write_check = WriteCheck(service.database, service.clock)
    app.state.collector = _data_collector(service)
    app.state.rollouts = _rollout_runner(service)
    app.state.registry = CollectorRegistry(auto_describe=False)
    app.state.replica = shared and _replica(app, shared)
    counters = app.state.collector.counters
    app.state.registry.register(ServiceMetrics(service, counters, app.state.login_throttle))
    install_error_handlers(app)
    app.router.routes.extend(_ROUTES)
    return app


def _service(
    config: ServiceConfig, database: Database, clock: Clock, monotonic: Clock
) -> ServiceContext:
    hub, steady_clock = Hub(), SteadyClock(clock, monotonic)
    live = LocalLiveRobots(hub) if database.is_sqlite else SharedLiveRobots(hub)
    dispatcher = CommandDispatcher(database, hub, clock)
    return ServiceContext(
        database=database,
        hub=hub,
        live=live,
        controller=RiskController(database, hub, clock, steady_clock),
        dispatcher=dispatcher,
        leases=LeaseDispatcher(database, live, dispatcher),
        requests=RequestDispatcher(database, live, dispatcher),
        clock=clock,
        monotonic=monotonic,
        steady_clock=steady_clock,
        config=config,
        signer=load_signer(config.audit_folder),
    )


def _shared_throttles(service: ServiceContext) -> SharedThrottles | None:
    """Return what replicas share of throttles; None on SQLite, which has one process."""
    database = service.database
    return None if database.is_sqlite else SharedThrottles(database, service.monotonic)


def _with_known_logins(service: ServiceContext, shared: LoginThrottle | None) -> LoginThrottle:
    """Return the throttle of logins, which knows from where users have logged in."""
    throttle = shared or LoginThrottle()
    with service.database.session() as session:
        for name, address in reversed(known_logins(session)):
            throttle.add_known(name, address)
    return throttle


def _oidc_sign_in(config: ServiceConfig) -> OidcSignIn | None:
    if config.oidc is None:
        return None
    from rtron.service.api.auth.oidc_client import OidcClient  # noqa: PLC0415 - few need Authlib

    return OidcSignIn(config.oidc, OidcClient(config.oidc, read_client_secret(config.oidc)))


def _data_collector(service: ServiceContext) -> DataCollector:
    tokens = GuardTokens(service.database, service.clock)
    authority = service.config.client_ca
    return DataCollector(
        database=service.database,
        hub=service.hub,
        handshake=service.controller,
        authenticate=tokens.authenticate,
        find_valid_tokens=tokens.find_valid,
        certificates=GuardCertificates(authority) if authority else None,
        token_renewal=TokenRenewal(tokens, _RENEWAL_INTERVAL_S),
        clock=service.clock,
        steady_clock=service.steady_clock,
        retention=service.config.retention,
        signer=service.signer,
    )


def _replica(app: FastAPI, throttles: SharedThrottles) -> Replica:
    service: ServiceContext = app.state.service
    watch = app.state.collector.token_watch
    replica = Replica(service.database, service.hub, service.controller, watch, throttles)
    service.dispatcher.send_elsewhere = replica.command_relay.send
    return replica


def _rollout_runner(service: ServiceContext) -> RolloutRunner:
    changes = RobotChanges(service.database, service.controller, service.clock)
    return RolloutRunner(
        service.database, changes, service.live, service.clock, service.hub.broadcast
    )


def _routes() -> tuple[BaseRoute, ...]:
    api = APIRouter(prefix=API, responses=ERROR_RESPONSES)
    for part in _API_ROUTES:
        api.include_router(part.router)
    routes = APIRouter()
    routes.include_router(api)
    routes.include_router(monitoring.router, responses=ERROR_RESPONSES)
    routes.include_router(websocket_endpoint.router)
    routes.include_router(console.router)
    return tuple(routes.routes)


_ROUTES = _routes()
"""Those of every app: to make them takes most of the time that an app takes."""


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
        Middleware(GZipMiddleware, minimum_size=_MIN_COMPRESSED_BYTES, compresslevel=_GZIP_LEVEL),
    ]


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    service: ServiceContext = app.state.service
    alerts = AlertDispatcher(service.database, service.hub, service.clock, service.monotonic)
    heads = _head_publisher(app, alerts)
    replica: Replica | None = app.state.replica
    sharing = replica.running() if replica else nullcontext()
    try:
        async with (
            app.state.collector.running(),
            alerts.running(),
            heads.running(),
            app.state.rollouts.running(),
            sharing,
        ):
            yield
    finally:
        service.stop_threads.shutdown()
        if app.state.oidc:
            app.state.oidc.client.close()
        service.database.close()


def _head_publisher(app: FastAPI, alerts: AlertDispatcher) -> HeadPublisher:
    service: ServiceContext = app.state.service
    return HeadPublisher(
        service.database,
        service.hub,
        service.signer,
        service.clock,
        journal=HeadsJournal(service.config.audit_folder, service.database),
        interval_s=service.config.heads_interval_s,
        on_heads=alerts.send_heads,
    )
