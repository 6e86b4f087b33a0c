"""The interaction graph of an app, and the risks found in it."""

from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from rtron.service.store.tables import GraphRow, RiskRow


def find_graph(session: Session, app_id: int) -> GraphRow | None:
    """Return the graph that somebody uploaded for an app."""
    return session.get(GraphRow, app_id)


def stored_risks(session: Session, app_id: int) -> Sequence[dict[str, Any]]:
    """Return the risks of the uploaded graph, as `rtron.risks/2` has them, in their order."""
    query = select(RiskRow).where(RiskRow.app_id == app_id).order_by(RiskRow.position)
    return [row.document for row in session.scalars(query)]


def store_graph(session: Session, graph: GraphRow, risks: Sequence[Mapping[str, Any]]) -> None:
    """Make this the graph of its app, with its risks as JSON, in place of the older ones."""
    session.merge(graph)
    session.execute(delete(RiskRow).where(RiskRow.app_id == graph.app_id))
    rows = [_risk(graph.app_id, position, dict(risk)) for position, risk in enumerate(risks)]
    session.add_all(rows)
    session.flush()


def _risk(app_id: int, position: int, document: dict[str, Any]) -> RiskRow:
    return RiskRow(
        app_id=app_id,
        risk=document["id"],
        position=position,
        kind=document["kind"],
        severity=document["severity"],
        document=document,
    )
