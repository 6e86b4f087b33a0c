"""The interaction graph of an app in the service: taken in, and shown with what guards it."""

import json
from typing import Any

from sqlalchemy.orm import Session

from rtron.errors import InputError, RTronError
from rtron.reports.app.page_data import page_data
from rtron.reports.app.risks_json import risks_to_json
from rtron.risks import discover
from rtron.service.api.credentials import Caller
from rtron.service.clock import Clock
from rtron.service.controller.app_graph import planned_graph
from rtron.service.controller.greetings import store_risk_models
from rtron.service.controller.known import Known, find_known
from rtron.service.store.audit import record, record_often
from rtron.service.store.database import Database
from rtron.service.store.graphs import find_graph, store_graph
from rtron.service.store.tables import GraphRow
from rtron.sources.graph_json import graph_to_json, parse_graph
from rtron.vocabulary import InteractionGraph, RiskReport, effective

MOST_ENDPOINTS = 20_000
MOST_RISKS = 5_000
LONGEST_ID = 200
"""The longest id of a risk, which has the name of a node or topic in it."""


def upload(
    database: Database, clock: Clock, caller: Caller, robot: str, data: bytes
) -> dict[str, Any]:
    """Store a graph (`rtron.graph/1` in JSON) and its risks; InputError if it is none.

    Returns the risks, `rtron.risks/1`.
    """
    deed = caller.deed("graph", robot, bytes=len(data))
    now = clock()
    try:
        graph = _bounded(parse_graph(data, "the graph"))
        risks: dict[str, Any] = risks_to_json(_bounded_risks(discover(graph)))
        with database.session() as session:
            known = find_known(session, robot)
            store_graph(session, _row(known, graph, caller.name, now), risks["risks"])
            store_risk_models(session, known.app, known.plan, known.settings)
            record(session, now, deed)
    except RTronError as error:
        with database.session() as session:
            record_often(session, now, deed, f"refused: {error}")
        raise
    return risks


def graph_page(session: Session, robot: str) -> dict[str, Any]:
    """Return the graph of a robot's app with risks and coordination nodes, as the console draws it.

    The shape is that of the HTML report; `source` is `uploaded` or `plan`.
    """
    known = find_known(session, robot)
    graph, row = _graph(session, known)
    page = page_data(graph, discover(graph), effective(known.plan, known.settings))
    return {
        "source": "uploaded" if row else "plan",
        "uploaded": row.uploaded if row else None,
        "by": row.by if row else "",
        **page,
    }


def risks_page(session: Session, robot: str) -> dict[str, Any]:
    """Return the risks of a robot's app, `rtron.risks/1`, with the `source` of its graph."""
    graph, row = _graph(session, find_known(session, robot))
    return {"source": "uploaded" if row else "plan", **risks_to_json(discover(graph))}


def _graph(session: Session, known: Known) -> tuple[InteractionGraph, GraphRow | None]:
    row = find_graph(session, known.app.id)
    if row is None:
        return planned_graph(known.plan), None
    return parse_graph(json.dumps(row.document).encode(), "the stored graph"), row


def _row(known: Known, graph: InteractionGraph, by: str, now: int) -> GraphRow:
    document = graph_to_json(graph)
    return GraphRow(app_id=known.app.id, document=document, uploaded=now, by=by)


def _bounded(graph: InteractionGraph) -> InteractionGraph:
    """Refuse what the database or a browser could not hold."""
    items = (*graph.nodes, *graph.endpoints, *graph.services, *graph.actions, *graph.unresolved)
    items += (*graph.clients, *graph.parameters)
    if len(items) > MOST_ENDPOINTS:
        help = "upload the graph of one app"
        raise InputError(f"more than {MOST_ENDPOINTS} nodes and endpoints", help=help)
    return graph


def _bounded_risks(report: RiskReport) -> RiskReport:
    if len(report.risks) > MOST_RISKS:
        raise InputError(f"more than {MOST_RISKS} risks", help="upload the graph of one app")
    ids = [risk.id for risk in report.risks]
    if len(set(ids)) < len(ids) or max(map(len, ids), default=0) > LONGEST_ID:
        raise InputError("two nodes or topics have one name, or one that is far too long")
    return report
