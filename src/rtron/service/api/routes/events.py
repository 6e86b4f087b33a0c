"""Events, a page at a time, what they add up to over time, and incidents."""

from typing import Annotated

from fastapi import APIRouter, Path, Query
from pydantic import BaseModel, Field

from rtron.errors import InputError
from rtron.service.api.auth.authorization import Reader
from rtron.service.api.context import ServiceDependency
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.schemas import EventPage, IncidentPage, Name, StoredIncident
from rtron.service.store.event_pages import MAX_PAGE_EVENTS, EventFilter, event_page
from rtron.service.store.incidents import find_incident, incident_page
from rtron.service.store.robots import find_robot
from rtron.service.store.time_series import TimeSeries, robot_time_series
from rtron.vocabulary import EventKind, GuardEventLevel

router = APIRouter()

_MAX_INT64 = (1 << 63) - 1
_LONGEST_NAME = 130
_HOUR = 3_600_000_000_000
Text = Annotated[str | None, Query(max_length=300)]
Time = Annotated[int | None, Query(ge=0, le=_MAX_INT64, description="Wall clock, ns since 1970.")]
Id = Annotated[int | None, Query(ge=1, le=_MAX_INT64)]


class EventQuery(BaseModel):
    """Which events, as an EventFilter has it."""

    robot: Text = None
    kind: EventKind | None = None
    level: GuardEventLevel | None = None
    node: Text = None
    topic: Text = None
    text: Text = None
    since: Time = None
    until: Time = None
    counts: bool = True


class EventPageQuery(EventQuery):
    """A page of them."""

    before: Id = None
    after: Id = None
    limit: int = Field(default=100, ge=1, le=MAX_PAGE_EVENTS)


@router.get("/events")
def list_events(
    _caller: Reader, service: ServiceDependency, query: Annotated[EventPageQuery, Query()]
) -> EventPage:
    """Return events, newest first; `before` is the `next` of the page before."""
    event_filter = EventFilter(**query.model_dump(exclude={"limit"}))
    with service.database.session() as session:
        return event_page(session, event_filter, query.limit)


@router.get("/robots/{robot}/figures")
def get_time_series(
    robot: Name, _caller: Reader, service: ServiceDependency, since: Time = None, until: Time = None
) -> TimeSeries:
    """Return what the robot's streams did from `since` (an hour ago) to `until` (now)."""
    end = service.clock() if until is None else until
    start = max(0, end - _HOUR) if since is None else since
    if start > end:
        raise InputError("`since` is after `until`", help="give the earlier time as `since`")
    with service.database.session() as session:
        if find_robot(session, robot) is None:
            raise NotFoundError(f"there is no robot {robot}")
        return robot_time_series(session, robot, start, end)


@router.get("/incidents")
def list_incidents(
    _caller: Reader,
    service: ServiceDependency,
    *,
    robot: Text = None,
    before: Id = None,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
) -> IncidentPage:
    """Return incidents in short, newest first; `before` is the `next` of the page before."""
    with service.database.session() as session:
        return incident_page(session, robot, before, limit)


@router.get("/robots/{robot}/incidents/{incident}")
def get_incident(
    robot: Name,
    incident: Annotated[str, Path(max_length=_LONGEST_NAME)],
    _caller: Reader,
    service: ServiceDependency,
) -> StoredIncident:
    """Return what a robot has told of an incident, by the name of its file there."""
    with service.database.session() as session:
        found = find_incident(session, robot, incident)
    if found is None:
        raise NotFoundError(f"{robot} has told of no such incident, or it is no longer kept")
    return found
