"""The interaction graph of an app in the service: taken in, and shown with what guards it."""

import json
from typing import Any

from sqlalchemy.orm import Session

from rtron.coherence import EffectivePlan
from rtron.errors import InputError, RTronError
from rtron.planning.plan_doubts import open_way_doubts
from rtron.reports.app.page_data import page_data
from rtron.reports.app.risks_json import risks_to_json
from rtron.service.controller.handshake import store_risk_models
from rtron.service.controller.robot_snapshot import RobotSnapshot, load_snapshot
from rtron.service.domain.clock import Clock
from rtron.service.domain.planned_graph import planned_graph
from rtron.service.domain.principal import Principal
from rtron.service.store.audit import record_event, record_repeatable
from rtron.service.store.database import Database
from rtron.service.store.graphs import find_graph, store_graph
from rtron.service.store.tables import GraphRow
from rtron.sources.graph_json import graph_to_json, parse_graph
from rtron.vocabulary import InteractionGraph, RiskReport
from rtron.workflows.scan import scan_graph
from rtron.workflows.unguarded import find_unguarded_commands

MAX_ENDPOINTS = 20_000
MAX_RISKS = 5_000
MAX_ID_LENGTH = 200
"""The longest id of a risk, which has the name of a node or topic in it."""


def upload_graph(
    database: Database, clock: Clock, caller: Principal, robot: str, data: bytes
) -> dict[str, Any]:
    """Store a graph (`rtron.graph/1` in JSON) and its risks; InputError if it is none.

    Returns the risks, `rtron.risks/2`.
    """
    event = caller.audit_event("graph", robot, bytes=len(data))
    now = clock()
    try:
        graph = _check_graph_size(parse_graph(data, "the graph"))
        scan = scan_graph(graph)
        _check_risks_size(scan.report)
        risks = risks_to_json(scan.report, inventory=scan.inventory)
        with database.session() as session:
            snapshot = load_snapshot(session, robot)
            store_graph(session, _graph_row(snapshot, graph, caller.name, now), risks["risks"])
            store_risk_models(session, snapshot.app, snapshot.plan, snapshot.settings)
            record_event(session, now, event)
    except RTronError as error:
        with database.session() as session:
            record_repeatable(session, now, event, f"refused: {error}")
        raise
    return risks


def get_graph_page(session: Session, robot: str) -> dict[str, Any]:
    """Return the graph of a robot's app with risks and coordination nodes, as the console draws it.

    The shape is that of the HTML report; `source` is `uploaded` or `plan`.
    """
    snapshot = load_snapshot(session, robot)
    graph, row = _load_graph(session, snapshot)
    effective = EffectivePlan(snapshot.plan, snapshot.settings)
    page = page_data(graph, scan_graph(graph).report, effective.plan)
    return {
        "source": "uploaded" if row else "plan",
        "uploaded": row.uploaded if row else None,
        "by": row.by if row else "",
        **page,
    }


def get_risks_page(session: Session, robot: str) -> dict[str, Any]:
    """Return the risks of a robot's app, `rtron.risks/2`, with the `source` of its graph.

    `unguarded` is what moves the robot and is not guarded by the plan in force, and what leads past
    it. Of a graph that is made of the plan, it and the inventory are empty: a plan does not know
    all that moves the robot.
    """
    snapshot = load_snapshot(session, robot)
    graph, row = _load_graph(session, snapshot)
    scan = scan_graph(graph)
    if row is None:
        return {"source": "plan", "unguarded": [], **risks_to_json(scan.report)}
    plan = EffectivePlan(snapshot.plan, snapshot.settings).plan
    open_ways = (*find_unguarded_commands(plan, scan), *open_way_doubts(plan, graph))
    return {
        "source": "uploaded",
        "unguarded": [{"thing": each.location, "why": each.message} for each in open_ways],
        **risks_to_json(scan.report, inventory=scan.inventory),
    }


def _load_graph(
    session: Session, snapshot: RobotSnapshot
) -> tuple[InteractionGraph, GraphRow | None]:
    row = find_graph(session, snapshot.app.id)
    if row is None:
        return planned_graph(snapshot.plan), None
    return parse_graph(json.dumps(row.document).encode(), "the stored graph"), row


def _graph_row(snapshot: RobotSnapshot, graph: InteractionGraph, by: str, now: int) -> GraphRow:
    document = graph_to_json(graph)
    return GraphRow(app_id=snapshot.app.id, document=document, uploaded=now, by=by)


def _check_graph_size(graph: InteractionGraph) -> InteractionGraph:
    """Refuse what the database or a browser could not hold."""
    items = (*graph.nodes, *graph.endpoints, *graph.services, *graph.actions, *graph.unresolved)
    items += (*graph.clients, *graph.parameters)
    if len(items) > MAX_ENDPOINTS:
        help = "upload the graph of one app"
        raise InputError(f"more than {MAX_ENDPOINTS} nodes and endpoints", help=help)
    return graph


def _check_risks_size(report: RiskReport) -> None:
    if len(report.risks) > MAX_RISKS:
        raise InputError(f"more than {MAX_RISKS} risks", help="upload the graph of one app")
    ids = [risk.id for risk in report.risks]
    if len(set(ids)) < len(ids) or max(map(len, ids), default=0) > MAX_ID_LENGTH:
        raise InputError("two nodes or topics have one name, or one that is far too long")
