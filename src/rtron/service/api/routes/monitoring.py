"""Figures for Prometheus, looked up when they are asked for."""

from collections.abc import Iterator

from fastapi import APIRouter, Request
from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from starlette.responses import Response

from rtron.service.api.auth.authorization import Measurer
from rtron.service.api.context import Service
from rtron.service.collector.tally import Tally
from rtron.service.domain.login_throttle import Attempts
from rtron.service.domain.schemas import SettingsOutcome
from rtron.service.store.retention import used_bytes
from rtron.service.store.robots import robots
from rtron.service.store.tables import EventRow, SettingsRow

router = APIRouter()


class _Text(Response):
    media_type = "text/plain"


@router.get("/metrics", response_class=_Text)
def metrics(_caller: Measurer, request: Request) -> Response:
    """Return the service's figures as Prometheus reads them."""
    registry: CollectorRegistry = request.app.state.registry
    return Response(generate_latest(registry), headers={"Content-Type": CONTENT_TYPE_LATEST})


class ServiceFigures(Collector):
    """What a service tells about itself and its robots."""

    def __init__(self, service: Service, tally: Tally, attempts: Attempts) -> None:
        self._service, self._tally, self._attempts = service, tally, attempts

    def describe(self) -> list[Metric]:
        """Name nothing beforehand: the database need not be asked for it."""
        return []

    def collect(self) -> Iterator[Metric]:
        """Look up all figures."""
        with self._service.database.session() as session:
            yield from _stored(session)
            names = [robot.name for robot, _ in robots(session)]
        yield _counter("rtron_logins_failed", "Logins that were refused.", self._attempts.failed)
        yield from (
            _counter(f"rtron_collector_{name}", help, value) for name, help, value in self._told()
        )
        yield from self._live(names)

    def _told(self) -> Iterator[tuple[str, str, float]]:
        tally = self._tally
        yield "events_stored", "Events stored since the service began.", tally.stored
        yield "events_repeated", "Events that came again and were stored.", tally.repeated
        yield "events_forgotten", "Events deleted by age or size.", tally.forgotten
        yield "transactions", "Transactions that stored events.", tally.batches
        yield "transactions_seconds", "Time that storing took.", tally.seconds
        yield "transactions_failed", "Transactions that failed.", tally.failures
        yield "connections", "Connections of guards.", tally.connected
        yield "connections_unauthorised", "Connections with no valid token.", tally.unauthorised
        yield "connections_refused", "Connections that broke the protocol.", tally.refused
        yield "connections_slow", "Connections that were too slow.", tally.slow

    def _live(self, names: list[str]) -> Iterator[Metric]:
        hub = self._service.hub
        yield _gauge("rtron_guards_connected", "Guards that are connected.", hub.connections())
        alarms = GaugeMetricFamily("rtron_alarms", "Alarms that stand.", labels=["robot"])
        lost = CounterMetricFamily("rtron_events_lost", "Events known lost.", labels=["robot"])
        for name in names:
            state = hub.state(name)
            alarms.add_metric([name], len(state.alarms) if state else 0)
            lost.add_metric([name], hub.dropped(name))
        yield alarms
        yield lost


def _stored(session: Session) -> Iterator[Metric]:
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
