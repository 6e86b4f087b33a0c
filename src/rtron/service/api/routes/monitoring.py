"""Figures for Prometheus, looked up when they are asked for."""

from collections.abc import Iterator, Mapping

from fastapi import APIRouter, Request
from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session
from starlette.responses import Response

from rtron.service.api.auth.authorization import MetricsReader
from rtron.service.api.context import ServiceContext, ServiceDependency
from rtron.service.api.schemas import ErrorResponse, Health
from rtron.service.collector.data_collector import CollectorCounters
from rtron.service.domain.login_throttle import LoginThrottle
from rtron.service.domain.schemas import SettingsOutcome
from rtron.service.store.accounts.last_use import short_transaction
from rtron.service.store.retention import used_bytes
from rtron.service.store.robots import list_robots
from rtron.service.store.tables import AuditRow, EventRow, SettingsRow
from rtron.vocabulary import GuardState

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
        yield _counter(
            "rtron_logins_failed", "Logins that were refused.", self._throttle.failed_count
        )
        yield from (
            _counter(f"rtron_collector_{name}", help, value)
            for name, help, value in self._collector_counters()
        )
        yield from self._live_metrics(names)

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

    def _live_metrics(self, names: list[str]) -> Iterator[Metric]:
        hub = self._service.hub
        yield _gauge("rtron_guards_connected", "Guards that are connected.", hub.connection_count())
        alarms = GaugeMetricFamily("rtron_alarms", "Alarms that stand.", labels=["robot"])
        lost = CounterMetricFamily("rtron_events_lost", "Events known lost.", labels=["robot"])
        for name in names:
            state = hub.state(name)
            alarms.add_metric([name], len(state.alarms) if state else 0)
            lost.add_metric([name], hub.lost_event_count(name))
        yield alarms
        yield lost
        yield lost_messages({name: hub.state(name) for name in names})


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
    yield _counter("rtron_events_stored", "Events stored since the database began.", newest)
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


@router.get("/readyz", responses={503: {"model": ErrorResponse}})
def readyz(service: ServiceDependency) -> Health:
    """Tell whether the database can be written; 503 if not. The row that is tried is not kept."""
    with short_transaction(service.database, _LOCK_TIMEOUT_MS) as session:
        row = AuditRow(
            at=service.clock(), who="", address="", action="", target="", detail={}, outcome=""
        )
        session.add(row)
        session.flush()
        session.execute(delete(AuditRow).where(AuditRow.id == row.id))
    return Health()
