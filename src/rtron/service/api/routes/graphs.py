"""The interaction graph of a robot's app, and its risks."""

from typing import Any

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool

from rtron.service.api.auth.authorization import DeveloperOnly, Reader
from rtron.service.api.context import ServiceDependency
from rtron.service.api.routes.robots import RobotName
from rtron.service.controller.graphs import get_graph_page, get_risks_page, upload_graph

router = APIRouter(prefix="/robots/{robot}")
_GRAPH_REQUEST = {
    "requestBody": {
        "required": True,
        "description": "`rtron.graph/1`, as `rtron scan --format graph` writes it.",
        "content": {"application/json": {"schema": {"type": "object"}}},
    }
}


@router.get("/graph")
def get_graph(robot: RobotName, _caller: Reader, service: ServiceDependency) -> dict[str, Any]:
    """Return the graph with its risks and coordination nodes, names as numbers into its lists.

    It is the one that was uploaded, or else (`source` is `plan`) what the plan tells of the app.
    """
    with service.database.session() as session:
        return get_graph_page(session, robot)


@router.put("/graph", openapi_extra=_GRAPH_REQUEST)
async def put_graph(
    robot: RobotName, request: Request, caller: DeveloperOnly, service: ServiceDependency
) -> dict[str, Any]:
    """Take the interaction graph of the app, find its risks, and return these."""
    data = await request.body()
    return await run_in_threadpool(
        upload_graph, service.database, service.clock, caller, robot, data
    )


@router.get("/risks")
def get_risks(robot: RobotName, _caller: Reader, service: ServiceDependency) -> dict[str, Any]:
    """Return the risks in the graph, `rtron.risks/2`."""
    with service.database.session() as session:
        return get_risks_page(session, robot)
