"""Robots: what they are, their coordination nodes and their settings."""

from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query
from fastapi.responses import JSONResponse

from rtron.service.api.auth.authorization import Reader, RoleHolder
from rtron.service.api.context import ServiceDependency
from rtron.service.api.schemas import RevisionConflict, StopRequest
from rtron.service.controller.node_parameters import get_node_parameters, list_node_parameters
from rtron.service.controller.robot_snapshot import load_current_app, load_snapshot
from rtron.service.controller.robot_summaries import get_robot_summary, list_robot_summaries
from rtron.service.domain.revisions import StaleRevisionError
from rtron.service.domain.schemas import (
    Name,
    NodeParameters,
    OverrideRequest,
    ReleaseRequest,
    RobotSummary,
    SettingsChange,
    SettingsView,
)
from rtron.service.store.settings import list_settings, settings_view

router = APIRouter(prefix="/robots")

RobotName = Annotated[Name, Path(description="The name of a get_robot.")]
NodeId = Annotated[str, Path(max_length=200, description="The id of a coordination get_node.")]
Revision = Annotated[int | None, Query(ge=0, le=(1 << 53) - 1)]
Limit = Annotated[int, Query(ge=1, le=200)]
CONFLICT_RESPONSE: dict[int | str, dict[str, Any]] = {
    HTTPStatus.CONFLICT: {"model": RevisionConflict}
}


@router.get("")
def list_robots(_caller: Reader, service: ServiceDependency) -> list[RobotSummary]:
    """Return all robots by name, each with what its guard is at now."""
    with service.database.session() as session:
        return list_robot_summaries(session, service.hub)


@router.get("/{robot}")
def get_robot(robot: RobotName, _caller: Reader, service: ServiceDependency) -> RobotSummary:
    """Return a robot, with what its guard is at now."""
    with service.database.session() as session:
        return get_robot_summary(session, service.hub, robot)


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
        return list_node_parameters(session, robot, caller.roles, service.clock())


@router.get("/{robot}/nodes/{node}")
def get_node(
    robot: RobotName, node: NodeId, caller: Reader, service: ServiceDependency
) -> NodeParameters:
    """Return one coordination node: its risk model, and what may be set."""
    with service.database.session() as session:
        return get_node_parameters(session, robot, node, caller.roles, service.clock())


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


@router.patch("/{robot}/settings", response_model=SettingsView, responses=CONFLICT_RESPONSE)
def change_settings(
    robot: RobotName, change: SettingsChange, caller: RoleHolder, service: ServiceDependency
) -> SettingsView | JSONResponse:
    """Change settings; each change is one revision, answered once it is stored and sent.

    403 where the roles do not suffice, 422 where the change makes no plan. 409 with the newest
    settings where somebody else was faster.
    """
    try:
        return service.controller.change(caller, robot, change)
    except StaleRevisionError as error:
        return _conflict_response(error)


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
    robot: RobotName, node: NodeId, caller: RoleHolder, service: ServiceDependency
) -> SettingsView:
    """Put a coordination node in force again before its override is over."""
    return service.controller.end_override(caller, robot, node)


@router.post("/{robot}/stop")
def start_emergency_stop(
    robot: RobotName,
    caller: RoleHolder,
    service: ServiceDependency,
    request: StopRequest | None = None,
) -> SettingsView:
    """Stop a robot until it is released: nothing that moves it passes. Every role may."""
    return service.controller.start_emergency_stop(caller, robot, request.reason if request else "")


@router.delete("/{robot}/stop", response_model=SettingsView, responses=CONFLICT_RESPONSE)
def release_emergency_stop(
    robot: RobotName, request: ReleaseRequest, caller: RoleHolder, service: ServiceDependency
) -> SettingsView | JSONResponse:
    """End the emergency stop that was seen at a revision; it takes a reason. Every role may.

    409 with the newest settings where that is another revision: somebody else may have stopped it.
    """
    try:
        return service.controller.release_emergency_stop(caller, robot, request)
    except StaleRevisionError as error:
        return _conflict_response(error)


def _conflict_response(error: StaleRevisionError) -> JSONResponse:
    conflict = RevisionConflict(error=str(error), help=error.help, newest=error.newest)
    return JSONResponse(conflict.model_dump(mode="json"), status_code=HTTPStatus.CONFLICT)
