"""The interaction graph of a robot's app, and its risks."""

from typing import Any

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool

from rtron.service.api.auth.authorization import DeveloperOnly, Reader
from rtron.service.api.context import Served
from rtron.service.api.routes.robots import Robot
from rtron.service.controller.graphs import graph_page, risks_page, upload

router = APIRouter(prefix="/robots/{robot}")
_GRAPH = {
    "requestBody": {
        "required": True,
        "description": "`rtron.graph/1`, as `rtron scan --format json` writes it.",
        "content": {"application/json": {"schema": {"type": "object"}}},
    }
}


@router.get("/graph")
def graph(robot: Robot, _caller: Reader, service: Served) -> dict[str, Any]:
    """Return the graph with its risks and coordination nodes, names as numbers into its lists.

    It is the one that was uploaded, or else (`source` is `plan`) what the plan tells of the app.
    """
    with service.database.session() as session:
        return graph_page(session, robot)


@router.put("/graph", openapi_extra=_GRAPH)
async def put_graph(
    robot: Robot, request: Request, caller: DeveloperOnly, service: Served
) -> dict[str, Any]:
    """Take the interaction graph of the app, find its risks, and return these."""
    data = await request.body()
    return await run_in_threadpool(upload, service.database, service.clock, caller, robot, data)


@router.get("/risks")
def risks(robot: Robot, _caller: Reader, service: Served) -> dict[str, Any]:
    """Return the risks in the graph, `rtron.risks/1`."""
    with service.database.session() as session:
        return risks_page(session, robot)
