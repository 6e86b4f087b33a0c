"""Robots: what they are, their coordination nodes and their settings."""

import asyncio
from collections.abc import Collection
from contextlib import suppress
from http import HTTPStatus
from typing import Annotated, Any
from urllib.parse import urlencode

from fastapi import APIRouter, Path, Query, Response
from pydantic import TypeAdapter
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from rtron.service.api.auth.authorization import (
    CommandingPerson,
    Principal,
    Reader,
    RoleHolder,
    StoppingCaller,
    check_group,
)
from rtron.service.api.context import ServiceContext, ServiceDependency, record_refusal
from rtron.service.api.schemas import (
    RevisionConflict,
    RobotQuery,
    StopRequest,
    StopsRequest,
    StopsResult,
    StopView,
)
from rtron.service.controller.fleet_stop import FleetStop
from rtron.service.controller.node_parameters import get_node_parameters, list_node_parameters
from rtron.service.controller.robot_snapshot import (
    get_robot_summary,
    list_robot_summaries,
    load_current_app,
    load_snapshot,
)
from rtron.service.domain.authority.leases import (
    LeaseChange,
    LeaseOutcome,
    LeaseView,
    RequestAnswer,
    RequestOutcome,
    RequestsView,
    may_command,
)
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import UserRole, is_within_reach
from rtron.service.domain.schemas import (
    Name,
    NodeParameters,
    OverrideEnd,
    OverrideRequest,
    ReleaseRequest,
    RestoreRequest,
    RobotSummary,
    SettingsChange,
    SettingsView,
)
from rtron.service.store.fleet.labels import labels_of
from rtron.service.store.robots import RobotFilter
from rtron.service.store.settings import list_settings, settings_view

router = APIRouter(prefix="/robots")

RobotName = Annotated[Name, Path(description="The name of a robot.")]
NodeId = Annotated[str, Path(max_length=200, description="The id of a coordination node.")]
Digest = Annotated[str, Path(pattern="^[0-9a-f]{64}$", description="The digest of a request.")]
LeaseName = Annotated[str, Path(max_length=200, description="The name of a lease.")]
Revision = Annotated[int | None, Query(ge=0, le=(1 << 53) - 1)]
Limit = Annotated[int, Query(ge=1, le=200)]
_SUMMARIES = TypeAdapter(list[RobotSummary])
CONFLICT_RESPONSE: dict[int | str, dict[str, Any]] = {
    HTTPStatus.CONFLICT: {"model": RevisionConflict}
}


@router.get("", response_model=list[RobotSummary])
def list_robots(
    _caller: Reader, service: ServiceDependency, query: Annotated[RobotQuery, Query()]
) -> Response:
    """Return a page of robots by name, each with what its guard is at now.

    Where there are more, the header `Link` has the next page: `after` is the last name of this one.
    """
    with service.database.session() as session:
        names = service.live.connected_robots(session) if query.connected is not None else ()
        chosen = RobotFilter(
            after=query.after,
            limit=query.limit + 1,
            text=query.text,
            app=query.app,
            label=query.label,
            within=names if query.connected else None,
            without=names if query.connected is False else (),
        )
        robots = list_robot_summaries(session, service.live, chosen)
    page, headers = robots[: query.limit], {}
    if len(robots) > query.limit:
        following = query.model_copy(update={"after": page[-1].name})
        parameters = urlencode(following.model_dump(mode="json", exclude_none=True))
        headers["Link"] = f'<?{parameters}>; rel="next"'
    left_out = {} if query.states else {"__all__": {"state"}}
    body = _SUMMARIES.dump_json(page, exclude=left_out)
    return Response(body, media_type="application/json", headers=headers)


@router.get("/{robot}")
def get_robot(robot: RobotName, _caller: Reader, service: ServiceDependency) -> RobotSummary:
    """Return a robot, with what its guard is at now."""
    with service.database.session() as session:
        return get_robot_summary(session, service.live, robot)


@router.get("/{robot}/plan")
def get_plan(robot: RobotName, _caller: Reader, service: ServiceDependency) -> dict[str, Any]:
    """Return the plan of the robot's app, without settings; durations are ns."""
    with service.database.session() as session:
        return load_current_app(session, robot).plan


@router.get("/{robot}/nodes")
def list_nodes(
    robot: RobotName, caller: Reader, service: ServiceDependency
) -> list[NodeParameters]:
    """Return the coordination nodes of the robot's app in the plan's order."""
    with service.database.session() as session:
        roles = _roles_at(session, caller, robot)
        return list_node_parameters(session, robot, roles, service.steady_clock())


@router.get("/{robot}/nodes/{node}")
def get_node(
    robot: RobotName, node: NodeId, caller: Reader, service: ServiceDependency
) -> NodeParameters:
    """Return one coordination node: its risk model, and what may be set."""
    with service.database.session() as session:
        roles = _roles_at(session, caller, robot)
        return get_node_parameters(session, robot, node, roles, service.steady_clock())


@router.get("/{robot}/settings")
def get_settings(robot: RobotName, _caller: Reader, service: ServiceDependency) -> SettingsView:
    """Return the newest settings, and what the guard said to them."""
    with service.database.session() as session:
        return settings_view(load_snapshot(session, robot).row)


@router.get("/{robot}/settings/history")
def settings_history(
    robot: RobotName,
    _caller: Reader,
    service: ServiceDependency,
    before: Revision = None,
    limit: Limit = 50,
) -> list[SettingsView]:
    """Return settings, newest first; `before` is the last revision that was seen."""
    with service.database.session() as session:
        app = load_current_app(session, robot)
        return [settings_view(row) for row in list_settings(session, app.id, before, limit)]


@router.patch("/{robot}/settings", responses=CONFLICT_RESPONSE)
def change_settings(
    robot: RobotName, change: SettingsChange, caller: RoleHolder, service: ServiceDependency
) -> SettingsView:
    """Change settings, for a reason; each change is one revision, stored and sent when it answers.

    403 where the roles do not suffice, 422 where the change makes no plan. 409 with the newest
    settings where somebody else was faster.
    """
    return service.controller.change(caller, robot, change)


@router.post("/{robot}/settings/restore", responses=CONFLICT_RESPONSE)
def restore_settings(
    robot: RobotName, request: RestoreRequest, caller: RoleHolder, service: ServiceDependency
) -> SettingsView:
    """Put the nodes' settings of an earlier revision in force again; statuses as of a change."""
    return service.controller.restore(caller, robot, request)


@router.post("/{robot}/nodes/{node}/override")
def start_override(
    robot: RobotName,
    node: NodeId,
    request: OverrideRequest,
    caller: RoleHolder,
    service: ServiceDependency,
) -> SettingsView:
    """Let pass for a while what an RSRCN or MSRCN forbids."""
    return service.controller.start_override(caller, robot, node, request)


@router.delete("/{robot}/nodes/{node}/override")
def end_override(
    robot: RobotName,
    node: NodeId,
    caller: RoleHolder,
    service: ServiceDependency,
    request: OverrideEnd | None = None,
) -> SettingsView:
    """Put a coordination node in force again before its override is over; it takes a reason."""
    reason = request.reason if request else ""
    return service.controller.end_override(caller, robot, node, reason)


@router.post("/{robot}/stop")
async def start_emergency_stop(
    robot: RobotName,
    caller: StoppingCaller,
    service: ServiceDependency,
    request: StopRequest | None = None,
) -> StopView:
    """Stop a robot until it is released: nothing that moves it passes. Every role may.

    It is stored. `outcome` tells whether the guard has confirmed it, `connected` whether it is sent
    to the guard at once, or waits until the guard connects.
    """
    reason = (request or StopRequest()).reason
    return await asyncio.get_running_loop().run_in_executor(
        service.stop_threads, _stop, service, caller, robot, reason
    )


def _stop(service: ServiceContext, caller: Principal, robot: str, reason: str) -> StopView:
    try:
        check_group(service, caller, robot)
    except ForbiddenError as error:
        record_refusal(service, caller.audit_event("stop", robot, reason=reason), str(error))
        raise
    view = service.controller.start_emergency_stop(caller, robot, reason)
    return StopView(**dict(view), connected=_is_connected(service, robot))


def _is_connected(service: ServiceContext, robot: str) -> bool:
    """Tell whether a robot's guard is connected, to this process if nobody knows of others."""
    with suppress(SQLAlchemyError), service.database.session() as session:
        return service.live.is_connected(session, robot)
    return service.hub.is_connected(robot)


@router.post("/stop")
async def start_emergency_stops(
    request: StopsRequest, caller: StoppingCaller, service: ServiceDependency
) -> StopsResult:
    """Stop several robots at once, each as if it were asked for alone."""
    return await asyncio.get_running_loop().run_in_executor(
        service.stop_threads, _stop_all, service, caller, request
    )


def _stop_all(service: ServiceContext, caller: Principal, request: StopsRequest) -> StopsResult:
    stop = FleetStop(
        caller=caller, robots=list(dict.fromkeys(request.robots)), reason=request.reason
    )
    failures = service.controller.start_emergency_stops(stop)
    connected, stopped = _connected_robots(service), [r for r in stop.robots if r not in failures]
    return StopsResult(
        sent=[robot for robot in stopped if robot in connected],
        waiting=[robot for robot in stopped if robot not in connected],
        failed={robot: str(failures[robot]) for robot in stop.robots if robot in failures},
    )


def _connected_robots(service: ServiceContext) -> Collection[str]:
    """Return the robots with a connected guard, those of this process if nobody knows others."""
    with suppress(SQLAlchemyError), service.database.session() as session:
        return service.live.connected_robots(session)
    return service.hub.connected_robots()


@router.delete("/{robot}/stop", responses=CONFLICT_RESPONSE)
def release_emergency_stop(
    robot: RobotName, request: ReleaseRequest, caller: RoleHolder, service: ServiceDependency
) -> SettingsView:
    """End the emergency stop that was seen at a revision; it takes a reason. Every role may.

    409 with the newest settings where that is another revision: somebody else may have stopped it.
    """
    return service.controller.release_emergency_stop(caller, robot, request)


@router.get("/{robot}/leases")
def list_leases(robot: RobotName, caller: Reader, service: ServiceDependency) -> list[LeaseView]:
    """Return the leases of the robot's app: who holds which streams, since when and why.

    Who held them before is in the events of the kind `lease`.
    """
    with service.database.session() as session:
        is_near = is_within_reach(caller.groups, labels_of(session, robot))
    return service.leases.views(robot, permitted=is_near and may_command(caller))


@router.post("/{robot}/leases/{lease}")
def change_lease(
    robot: RobotName,
    lease: LeaseName,
    change: LeaseChange,
    caller: CommandingPerson,
    service: ServiceDependency,
) -> LeaseOutcome:
    """Give a lease to a commander, renew what you have given, or end it; the guard decides.

    It goes by the rank that the plan gives people here. 409 if the guard refuses, 503 if it is not
    connected or does not answer.
    """
    return service.leases.change(caller, robot, lease, change)


@router.get("/{robot}/requests")
def list_requests(robot: RobotName, caller: Reader, service: ServiceDependency) -> RequestsView:
    """Return what clients of the robot's bridge ask for, word for word, and wait for a person."""
    with service.database.session() as session:
        is_near = is_within_reach(caller.groups, labels_of(session, robot))
    return service.requests.view(robot, caller, is_near=is_near)


@router.post("/{robot}/requests/{digest}")
def answer_request(
    robot: RobotName,
    digest: Digest,
    answer: RequestAnswer,
    caller: CommandingPerson,
    service: ServiceDependency,
) -> RequestOutcome:
    """Approve or refuse the request of a digest, which is of its content too; the bridge decides.

    Who may is in the rights of the bridge. 409 if it waits no more, 503 if the guard is not
    connected or does not answer.
    """
    return service.requests.answer(caller, robot, digest, answer)


def _roles_at(session: Session, caller: Principal, robot: str) -> frozenset[UserRole]:
    """Return the roles of the caller at a robot: none where it is in no group of the caller."""
    is_near = is_within_reach(caller.groups, labels_of(session, robot))
    return caller.roles if is_near else frozenset()
