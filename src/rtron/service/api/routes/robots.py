"""Robots: what they are, their coordination nodes and their settings."""

from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query
from fastapi.responses import JSONResponse

from rtron.service.api.auth.authorization import Member, Reader
from rtron.service.api.context import Served
from rtron.service.controller.node_parameters import all_parameters, parameters
from rtron.service.controller.robot_snapshot import find_current_app, find_known
from rtron.service.controller.robot_summaries import summaries, summary
from rtron.service.domain.revisions import RevisionError
from rtron.service.domain.schemas import (
    Name,
    NodeParameters,
    OverrideRequest,
    Overtaken,
    ReleaseRequest,
    RobotSummary,
    SettingsChange,
    SettingsView,
    StopRequest,
)
from rtron.service.store.settings import history, settings_view

router = APIRouter(prefix="/robots")

Robot = Annotated[Name, Path(description="The name of a robot.")]
NodeId = Annotated[str, Path(max_length=200, description="The id of a coordination node.")]
Revision = Annotated[int | None, Query(ge=0, le=(1 << 53) - 1)]
Limit = Annotated[int, Query(ge=1, le=200)]
Conflict: dict[int | str, dict[str, Any]] = {HTTPStatus.CONFLICT: {"model": Overtaken}}


@router.get("")
def robots(_caller: Reader, service: Served) -> list[RobotSummary]:
    """Return all robots by name, each with what its guard is at now."""
    with service.database.session() as session:
        return summaries(session, service.hub)


@router.get("/{robot}")
def robot(robot: Robot, _caller: Reader, service: Served) -> RobotSummary:
    """Return a robot, with what its guard is at now."""
    with service.database.session() as session:
        return summary(session, service.hub, robot)


@router.get("/{robot}/plan")
def plan(robot: Robot, _caller: Reader, service: Served) -> dict[str, Any]:
    """Return the plan of the robot's app, without settings; durations are ns."""
    with service.database.session() as session:
        return find_current_app(session, robot).plan


@router.get("/{robot}/nodes")
def nodes(robot: Robot, caller: Reader, service: Served) -> list[NodeParameters]:
    """Return the coordination nodes of the robot's app in the plan's order."""
    with service.database.session() as session:
        return all_parameters(session, robot, caller.roles, service.clock())


@router.get("/{robot}/nodes/{node}")
def node(robot: Robot, node: NodeId, caller: Reader, service: Served) -> NodeParameters:
    """Return one coordination node: its risk model, and what may be set."""
    with service.database.session() as session:
        return parameters(session, robot, node, caller.roles, service.clock())


@router.get("/{robot}/settings")
def settings(robot: Robot, _caller: Reader, service: Served) -> SettingsView:
    """Return the newest settings, and what the guard said to them."""
    with service.database.session() as session:
        return settings_view(find_known(session, robot).row)


@router.get("/{robot}/settings/history")
def settings_history(
    robot: Robot, _caller: Reader, service: Served, before: Revision = None, limit: Limit = 50
) -> list[SettingsView]:
    """Return settings, newest first; `before` is the last revision that was seen."""
    with service.database.session() as session:
        app = find_current_app(session, robot)
        return [settings_view(row) for row in history(session, app.id, before, limit)]


@router.patch("/{robot}/settings", response_model=SettingsView, responses=Conflict)
def change_settings(
    robot: Robot, change: SettingsChange, caller: Member, service: Served
) -> SettingsView | JSONResponse:
    """Change settings; each change is one revision, answered once it is stored and sent.

    403 where the roles do not suffice, 422 where the change makes no plan. 409 with the newest
    settings where somebody else was faster.
    """
    try:
        return service.controller.change(caller, robot, change)
    except RevisionError as error:
        return _overtaken(error)


@router.post("/{robot}/nodes/{node}/override")
def override(
    robot: Robot, node: NodeId, request: OverrideRequest, caller: Member, service: Served
) -> SettingsView:
    """Let pass for a while what an RSRCN or MSRCN forbids."""
    return service.controller.override(caller, robot, node, request)


@router.delete("/{robot}/nodes/{node}/override")
def end_override(robot: Robot, node: NodeId, caller: Member, service: Served) -> SettingsView:
    """Put a coordination node in force again before its override is over."""
    return service.controller.end_override(caller, robot, node)


@router.post("/{robot}/stop")
def stop(
    robot: Robot, caller: Member, service: Served, request: StopRequest | None = None
) -> SettingsView:
    """Stop a robot until it is released: nothing that moves it passes. Every role may."""
    return service.controller.stop(caller, robot, request.reason if request else "")


@router.delete("/{robot}/stop", response_model=SettingsView, responses=Conflict)
def release(
    robot: Robot, request: ReleaseRequest, caller: Member, service: Served
) -> SettingsView | JSONResponse:
    """End the emergency stop that was seen at a revision; it takes a reason. Every role may.

    409 with the newest settings where that is another revision: somebody else may have stopped it.
    """
    try:
        return service.controller.release(caller, robot, request)
    except RevisionError as error:
        return _overtaken(error)


def _overtaken(error: RevisionError) -> JSONResponse:
    told = Overtaken(error=str(error), help=error.help, newest=error.newest)
    return JSONResponse(told.model_dump(mode="json"), status_code=HTTPStatus.CONFLICT)
