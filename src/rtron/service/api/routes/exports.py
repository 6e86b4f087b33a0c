"""What the console shows, as files: CSV or JSON, a page of the database at a time."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import StreamingResponse
from pydantic import ConfigDict, Field

from rtron.reports.csv_lines import Row, csv_lines
from rtron.service.api.auth.authorization import Reader
from rtron.service.api.context import ServiceContext, ServiceDependency
from rtron.service.api.routes.events import EventQuery
from rtron.service.controller.robot_snapshot import list_robot_summaries, load_current_app
from rtron.service.domain.alarms import Acknowledgement
from rtron.service.domain.schemas import EventView, Name, RequestModel, RobotSummary, SettingsView
from rtron.service.domain.shifts import Handover
from rtron.service.store.event_pages import EventFilter, event_page
from rtron.service.store.robots import RobotFilter
from rtron.service.store.settings import list_settings, settings_view
from rtron.service.store.shifts import list_acknowledgements, list_handovers
from rtron.vocabulary import StringEnum


def json_array(rows: Iterable[Row], _columns: Sequence[str]) -> Iterator[str]:
    """Yield the lines of a JSON array of objects, times in ns since 1970."""
    separator = "[\n"
    for row in rows:
        yield separator + json.dumps(row)
        separator = ",\n"
    yield "[]\n" if separator == "[\n" else "\n]\n"


class ExportFormat(StringEnum):
    """What a file is for: a spreadsheet, or a program."""

    CSV = "csv"
    JSON = "json"


_MEDIA_TYPES: Mapping[ExportFormat, str] = {
    ExportFormat.CSV: "text/csv; charset=utf-8",
    ExportFormat.JSON: "application/json",
}
_LINES: Mapping[ExportFormat, Callable[[Iterable[Row], Sequence[str]], Iterator[str]]] = {
    ExportFormat.CSV: csv_lines,
    ExportFormat.JSON: json_array,
}


def export_file(
    name: str, rows: Iterable[Row], columns: Sequence[str], format: ExportFormat
) -> StreamingResponse:
    """Return rows as a file that a browser stores."""
    headers = {"Content-Disposition": f'attachment; filename="rtron-{name}.{format.value}"'}
    lines = _LINES[format](rows, columns)
    return StreamingResponse(lines, media_type=_MEDIA_TYPES[format], headers=headers)


router = APIRouter(prefix="/export")

MAX_EVENTS = 100_000
"""The most events of one file."""
MAX_ROBOTS = 10_000
_PAGE = 500
_ROBOT_COLUMNS = (
    "name", "app", "ros", "connected", "seen", "dry_run", "revision", "outcome", "stop",
    "alarms", "acknowledged", "overridden", "stopped", "dropped",
)  # fmt: skip


Format = Annotated[ExportFormat, Query(description="csv or json")]


class EventExportQuery(EventQuery):
    """Which events, and as what."""

    model_config = ConfigDict(extra="forbid")

    format: ExportFormat = ExportFormat.CSV


class RobotExport(RequestModel):
    """Robots by name, in the order of the file, and as what."""

    robots: list[Name] = Field(max_length=MAX_ROBOTS)
    format: ExportFormat = ExportFormat.CSV


@router.get("/robots", response_class=StreamingResponse)
def export_robots(
    _caller: Reader, service: ServiceDependency, format: Format = ExportFormat.CSV
) -> StreamingResponse:
    """Return all robots in short."""
    with service.database.session() as session:
        robots = list_robot_summaries(session, service.live, RobotFilter())
    return _robots_file(robots, format)


@router.post("/robots", response_class=StreamingResponse)
def export_chosen_robots(
    _caller: Reader, service: ServiceDependency, chosen: RobotExport
) -> StreamingResponse:
    """Return these robots in short, in this order; those that are not known are left out."""
    with service.database.session() as session:
        within = RobotFilter(within=chosen.robots)
        robots = {each.name: each for each in list_robot_summaries(session, service.live, within)}
    found = [robots[name] for name in dict.fromkeys(chosen.robots) if name in robots]
    return _robots_file(found, chosen.format)


@router.get("/events", response_class=StreamingResponse)
def export_events(
    _caller: Reader, service: ServiceDependency, query: Annotated[EventExportQuery, Query()]
) -> StreamingResponse:
    """Return the events that fit, newest first, at most 100,000."""
    event_filter = EventFilter(**query.model_dump(exclude={"format"}))
    rows = (each.model_dump(mode="json") for each in _events(service, event_filter))
    return export_file("events", rows, tuple(EventView.model_fields), query.format)


@router.get("/settings", response_class=StreamingResponse)
def export_settings(
    robot: Name, _caller: Reader, service: ServiceDependency, format: Format = ExportFormat.CSV
) -> StreamingResponse:
    """Return all settings of a robot's app, newest first."""
    with service.database.session() as session:
        app = load_current_app(session, robot)
        views = [settings_view(row) for row in list_settings(session, app.id, None, MAX_EVENTS)]
    rows = (each.model_dump(mode="json") for each in views)
    return export_file(f"settings-{robot}", rows, tuple(SettingsView.model_fields), format)


@router.get("/acknowledgements", response_class=StreamingResponse)
def export_acknowledgements(
    _caller: Reader, service: ServiceDependency, format: Format = ExportFormat.CSV
) -> StreamingResponse:
    """Return who has seen which alarm, newest first."""
    with service.database.session() as session:
        found = list_acknowledgements(session, None, MAX_EVENTS)
    rows = (each.model_dump(mode="json") for _, each in found)
    return export_file("acknowledgements", rows, tuple(Acknowledgement.model_fields), format)


@router.get("/handovers", response_class=StreamingResponse)
def export_handovers(
    _caller: Reader, service: ServiceDependency, format: Format = ExportFormat.CSV
) -> StreamingResponse:
    """Return the handover notes, newest first."""
    with service.database.session() as session:
        notes = list_handovers(session, None, MAX_EVENTS)
    rows = (each.model_dump(mode="json") for each in notes)
    return export_file("handovers", rows, tuple(Handover.model_fields), format)


def _robots_file(robots: Sequence[RobotSummary], format: ExportFormat) -> StreamingResponse:
    rows = (each.model_dump(mode="json", exclude={"state"}) for each in robots)
    return export_file("robots", rows, _ROBOT_COLUMNS, format)


def _events(service: ServiceContext, event_filter: EventFilter) -> Iterator[EventView]:
    """Yield events page by page, each in a transaction of its own: nobody waits for a slow line."""
    for _ in range(MAX_EVENTS // _PAGE):
        with service.database.session() as session:
            page = event_page(session, event_filter, _PAGE)
        yield from page.events
        if page.next is None:
            return
        event_filter = replace(event_filter, before=page.next)
