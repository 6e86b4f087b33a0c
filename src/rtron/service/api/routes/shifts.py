"""What people of one shift tell each other: acknowledged alarms and handover notes."""

from typing import Annotated

from fastapi import APIRouter, Query

from rtron.service.api.auth.authorization import Principal, Reader, RoleHolder
from rtron.service.api.context import ServiceContext, ServiceDependency, audit_transaction
from rtron.service.controller.alarm_acknowledgement import (
    acknowledge_present,
    current_situation,
    present_alarms,
)
from rtron.service.domain.alarms import HANDOVER_MESSAGE, acknowledged_change
from rtron.service.domain.audit_events import truncated_json
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import check_reach
from rtron.service.domain.shifts import (
    AcknowledgementPage,
    AcknowledgeRequest,
    AcknowledgeResult,
    AlarmReference,
    Handover,
    HandoverPage,
    NewHandover,
)
from rtron.service.store.fleet.labels import labels_of
from rtron.service.store.settings import ChangeAuthor
from rtron.service.store.shifts import add_handover, list_acknowledgements, list_handovers

router = APIRouter()

Id = Annotated[int | None, Query(ge=1, le=(1 << 63) - 1)]
Limit = Annotated[int, Query(ge=1, le=200)]


@router.get("/acknowledgements")
def get_acknowledgements(
    _caller: Reader, service: ServiceDependency, before: Id = None, limit: Limit = 50
) -> AcknowledgementPage:
    """Return who has seen which alarm, newest first; `before` is the `next` of the page before."""
    with service.database.session() as session:
        rows = list_acknowledgements(session, before, limit + 1)
    page = rows[:limit]
    following = page[-1][0] if len(rows) > limit else None
    return AcknowledgementPage(acknowledgements=[view for _, view in page], next=following)


@router.post("/acknowledgements")
def acknowledge_alarms(
    request: AcknowledgeRequest, caller: RoleHolder, service: ServiceDependency
) -> AcknowledgeResult:
    """Note that the caller has seen alarms; those that are none any more are returned.

    `failed` says why it may not be noted at a robot: it is in no group of the caller.
    """
    with service.database.session() as session:
        present, gone = present_alarms(session, service.live, request.alarms)
    result = AcknowledgeResult(acknowledged=0, gone=gone, failed={})
    for robot, alarms in present.items():
        if refusal := _acknowledge_robot(service, caller, robot, alarms, request.note):
            result.failed[robot] = refusal
        else:
            result.acknowledged += len(alarms)
    return result


def _acknowledge_robot(
    service: ServiceContext, caller: Principal, robot: str, alarms: list[AlarmReference], note: str
) -> str:
    """Note that alarms of a robot are seen; return why the caller may not, "" if it is done."""
    seen = truncated_json([" ".join(filter(None, alarm.key)) for alarm in alarms])
    author = ChangeAuthor(by=caller.name, reason=note, at=service.clock())
    event = caller.audit_event("acknowledge", robot, alarms=seen, note=note)
    try:
        with audit_transaction(service, event) as session:
            check_reach(caller, robot, labels_of(session, robot))
            left = acknowledge_present(session, robot, alarms, author)
    except ForbiddenError as error:
        return str(error)
    service.hub.broadcast_change(robot, acknowledged_change(left))
    return ""


@router.get("/handovers")
def get_handovers(
    _caller: Reader, service: ServiceDependency, before: Id = None, limit: Limit = 50
) -> HandoverPage:
    """Return handover notes, newest first; `before` is the `next` of the page before."""
    with service.database.session() as session:
        notes = list(list_handovers(session, before, limit + 1))
    page = notes[:limit]
    return HandoverPage(handovers=page, next=page[-1].id if len(notes) > limit else None)


@router.post("/handovers", status_code=201)
def write_handover(new: NewHandover, caller: RoleHolder, service: ServiceDependency) -> Handover:
    """Write a note for the next shift; what is so now is counted with it."""
    with audit_transaction(service, caller.audit_event("handover", "")) as session:
        situation = current_situation(session, service.live)
        note = add_handover(session, caller.name, new.text, situation, service.clock())
    service.hub.broadcast(HANDOVER_MESSAGE)
    return note
