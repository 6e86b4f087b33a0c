"""Roll-outs: a change of settings that goes out to many robots in stages."""

from typing import Annotated

from fastapi import APIRouter, Path, Query

from rtron.service.api.auth.authorization import Reader, RoleHolder
from rtron.service.api.context import ServiceDependency, audit_transaction
from rtron.service.domain.audit_events import truncated_json
from rtron.service.domain.rollouts.schemas import (
    NewRollout,
    RolloutCancellation,
    RolloutPage,
    RolloutRequest,
    RolloutRobotPage,
    RolloutView,
)
from rtron.service.rollouts.control import (
    cancel_rollout,
    pause_rollout,
    resume_rollout,
    rollout_page,
    rollout_robot_page,
    rollout_view,
)
from rtron.service.rollouts.start import start_rollout
from rtron.wire.common.link_protocol import plan_document_digest

router = APIRouter(prefix="/rollouts")

_MAX_ID = (1 << 53) - 1
RolloutId = Annotated[int, Path(ge=1, le=_MAX_ID)]
Before = Annotated[int | None, Query(ge=1, le=_MAX_ID)]
After = Annotated[int, Query(ge=-1, le=_MAX_ID)]
Limit = Annotated[int, Query(ge=1, le=200)]
RobotLimit = Annotated[int, Query(ge=1, le=1000)]


@router.get("")
def list_rollouts(
    _caller: Reader, service: ServiceDependency, before: Before = None, limit: Limit = 50
) -> RolloutPage:
    """Return roll-outs, newest first; `before` is the `next` of the page before."""
    with service.database.session() as session:
        return rollout_page(session, before, limit)


@router.post("", status_code=201)
def start(new: NewRollout, caller: RoleHolder, service: ServiceDependency) -> RolloutView:
    """Begin a roll-out. It takes the rights of changing each of the robots.

    403 and 422 as for one robot, which is named; 409 where another roll-out has one of them.
    """
    event = caller.audit_event(
        "rollout",
        "robots",
        robots=truncated_json(new.robots.model_dump(exclude_none=True)),
        nodes=truncated_json(new.nodes),
        plan=plan_document_digest(new.plan) if new.plan else "",
        reason=new.reason,
    )
    with audit_transaction(service, event) as session:
        rollout = start_rollout(session, caller, new, service.clock())
        return rollout_view(session, rollout.id)


@router.get("/{rollout}")
def get_rollout(rollout: RolloutId, _caller: Reader, service: ServiceDependency) -> RolloutView:
    """Return a roll-out: its stages, its limits, and how many robots are at what."""
    with service.database.session() as session:
        return rollout_view(session, rollout)


@router.get("/{rollout}/robots")
def list_rollout_robots(
    rollout: RolloutId,
    _caller: Reader,
    service: ServiceDependency,
    after: After = -1,
    limit: RobotLimit = 200,
) -> RolloutRobotPage:
    """Return its robots in the order of getting the change; `after` is `next` of the page before.

    The one with which the first page begins is the canary.
    """
    with service.database.session() as session:
        return rollout_robot_page(session, rollout, after, limit)


@router.post("/{rollout}/pause")
def pause(
    rollout: RolloutId, request: RolloutRequest, caller: RoleHolder, service: ServiceDependency
) -> RolloutView:
    """Let no further robot get the change; when a limit is passed it still goes back."""
    event = caller.audit_event("rollout.pause", _target(rollout), reason=request.reason)
    with audit_transaction(service, event) as session:
        pause_rollout(session, caller, rollout, request.reason, service.clock())
        return rollout_view(session, rollout)


@router.post("/{rollout}/resume")
def resume(
    rollout: RolloutId, request: RolloutRequest, caller: RoleHolder, service: ServiceDependency
) -> RolloutView:
    """Go on with a roll-out that is paused; it takes the rights of the change."""
    event = caller.audit_event("rollout.resume", _target(rollout), reason=request.reason)
    with audit_transaction(service, event) as session:
        resume_rollout(session, caller, rollout, request.reason, service.clock())
        return rollout_view(session, rollout)


@router.post("/{rollout}/cancel")
def cancel(
    rollout: RolloutId, request: RolloutCancellation, caller: RoleHolder, service: ServiceDependency
) -> RolloutView:
    """End a roll-out: the change goes back, or stays where it is; it takes the rights of it."""
    event = caller.audit_event(
        "rollout.cancel", _target(rollout), reason=request.reason, keep=request.keep
    )
    with audit_transaction(service, event) as session:
        cancel_rollout(session, caller, rollout, request, service.clock())
        return rollout_view(session, rollout)


def _target(rollout: int) -> str:
    return f"rollout/{rollout}"
