"""Figures for Prometheus, looked up when they are asked for."""

import asyncio
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from fastapi import APIRouter, Request
from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session
from starlette.responses import Response

from rtron.errors import SourceError
from rtron.service.api.auth.authorization import MetricsReader
from rtron.service.api.context import ServiceContext, ServiceDependency
from rtron.service.api.schemas import ErrorResponse, Health
from rtron.service.collector.data_collector import CollectorCounters
from rtron.service.domain.clock import Clock
from rtron.service.domain.login_throttle import LoginThrottle
from rtron.service.domain.schemas import SettingsOutcome
from rtron.service.live.live_robots import LiveRobot
from rtron.service.store.accounts.last_use import short_transaction
from rtron.service.store.database import Database
from rtron.service.store.partitions.event_partitions import stored_count
from rtron.service.store.retention import used_bytes
from rtron.service.store.robots import list_robots
from rtron.service.store.tables import AuditRow, EventRow, SettingsRow
from rtron.vocabulary import GuardState

if TYPE_CHECKING:
    from rtron.service.replicas.replica import Replica

router = APIRouter()


class _PlainTextResponse(Response):
    media_type = "text/plain"


@router.get("/metrics", response_class=_PlainTextResponse)
def metrics(_caller: MetricsReader, request: Request) -> Response:
    """Return the service's figures as Prometheus reads them."""
    registry: CollectorRegistry = request.app.state.registry
    return Response(generate_latest(registry), headers={"Content-Type": CONTENT_TYPE_LATEST})


class ServiceMetrics(Collector):
    """What a service tells about itself and its robots."""

    def __init__(
        self, service: ServiceContext, counters: CollectorCounters, throttle: LoginThrottle
    ) -> None:
        self._service, self._counters, self._throttle = service, counters, throttle

    def describe(self) -> list[Metric]:
        """Name nothing beforehand: the database need not be asked for it."""
        return []

    def collect(self) -> Iterator[Metric]:
        """Look up all figures."""
        with self._service.database.session() as session:
            yield from _stored_metrics(session)
            names = [robot.name for robot, _ in list_robots(session)]
            robots = self._service.live.find(session, names)
        yield _counter(
            "rtron_logins_failed", "Logins that were refused.", self._throttle.failed_count
        )
        yield from (
            _counter(f"rtron_collector_{name}", help, value)
            for name, help, value in self._collector_counters()
        )
        yield from self._live_metrics(robots)

    def _collector_counters(self) -> Iterator[tuple[str, str, float]]:
        counters = self._counters
        yield "events_stored", "Events stored since the service began.", counters.stored_events
        yield (
            "events_repeated",
            "Events that came again and were stored.",
            counters.duplicate_events,
        )
        yield "events_forgotten", "Events deleted by age or size.", counters.pruned_events
        yield "transactions", "Transactions that stored events.", counters.transactions
        yield "transactions_seconds", "Time that storing took.", counters.transaction_seconds
        yield "transactions_failed", "Transactions that failed.", counters.failed_batches
        yield "connections", "Connections of guards.", counters.connections
        yield (
            "connections_unauthorised",
            "Connections with no valid token.",
            counters.unauthorised_connections,
        )
        yield (
            "connections_refused",
            "Connections that broke the protocol.",
            counters.protocol_violations,
        )
        yield "connections_slow", "Connections that were too slow.", counters.slow_connections

    def _live_metrics(self, robots: Mapping[str, LiveRobot]) -> Iterator[Metric]:
        connections = self._service.hub.connection_count()
        yield _gauge("rtron_guards_connected", "Guards that are connected.", connections)
        alarms = GaugeMetricFamily("rtron_alarms", "Alarms that stand.", labels=["robot"])
        lost = CounterMetricFamily("rtron_events_lost", "Events known lost.", labels=["robot"])
        for name, robot in robots.items():
            alarms.add_metric([name], len(robot.state.alarms) if robot.state else 0)
            lost.add_metric([name], robot.dropped)
        yield alarms
        yield lost
        yield lost_messages({name: robot.state for name, robot in robots.items()})


def lost_messages(states: Mapping[str, GuardState | None]) -> Metric:
    """Return the messages that guards know lost, since each began, as their last states say."""
    labels = ["robot", "topic", "side"]
    found = CounterMetricFamily("rtron_messages_lost", "Messages lost by a guard.", labels=labels)
    for robot, state in states.items():
        for stream in state.streams if state else ():
            before = sum(counts.lost for counts in stream.flows.values())
            found.add_metric([robot, stream.topic, "before"], before)
            found.add_metric([robot, stream.topic, "behind"], stream.lost_behind)
        for topic, count in state.lost_events.items() if state else ():
            found.add_metric([robot, topic, "event"], count)
    return found


def _stored_metrics(session: Session) -> Iterator[Metric]:
    newest = session.scalar(select(func.max(EventRow.id))) or 0
    stored = stored_count(newest)
    yield _counter("rtron_events_stored", "Events stored since the database began.", stored)
    pending = select(func.count()).where(SettingsRow.outcome == SettingsOutcome.PENDING.value)
    waiting = session.scalar(pending) or 0
    yield _gauge("rtron_settings_pending", "Settings that no guard has answered.", waiting)
    yield _gauge("rtron_database_bytes", "What the events take on disk.", used_bytes(session))


def _gauge(name: str, help: str, value: float) -> Metric:
    return GaugeMetricFamily(name, help, value=value)


def _counter(name: str, help: str, value: float) -> Metric:
    return CounterMetricFamily(name, help, value=value)


_LOCK_TIMEOUT_MS = 2000


@router.get("/healthz")
async def healthz() -> Health:
    """Tell that the service runs."""
    return Health()


class WriteCheck:
    """Tries whether the database can be written, once for all who ask meanwhile: strangers may ask.

    Used in the event loop.
    """

    def __init__(self, database: Database, clock: Clock) -> None:
        self._database, self._clock = database, clock
        self._running: asyncio.Future[None] | None = None

    async def run(self) -> None:
        """Raise SQLAlchemyError if the database cannot be written."""
        if self._running is None or self._running.done():
            self._running = asyncio.ensure_future(asyncio.to_thread(self._try_write))
        await asyncio.shield(self._running)

    def _try_write(self) -> None:
        """Write a row that is not kept."""
        with short_transaction(self._database, _LOCK_TIMEOUT_MS) as session:
            row = AuditRow(
                at=self._clock(), who="", address="", action="", target="", detail={}, outcome=""
            )
            session.add(row)
            session.flush()
            session.execute(delete(AuditRow).where(AuditRow.id == row.id))


@router.get("/readyz", responses={503: {"model": ErrorResponse}})
async def readyz(request: Request) -> Health:
    """Tell whether the database can be written; 503 if not."""
    check: WriteCheck = request.app.state.write_check
    await check.run()
    return Health()


@router.get("/readyz/read", responses={503: {"model": ErrorResponse}})
def readyz_read(request: Request, service: ServiceDependency) -> Health:
    """Tell whether this replica can serve people and guards: it reads, and hears of the others.

    A balancer asks this: a full disk takes no replica away.
    """
    replica: Replica | None = request.app.state.replica
    if replica and not replica.is_connected:
        raise SourceError("cut off from the other replicas", help="is the database away?")
    with service.database.session() as session:
        session.execute(select(1))
    return Health()
