"""The incidents of robots: reports that they have sent, each once, within bounds.

The first report of a name stays: a robot cannot change what it has told.
"""

from typing import Any

from sqlalchemy import (
    BigInteger,
    ForeignKey,
    Index,
    Integer,
    String,
    UniqueConstraint,
    delete,
    func,
    or_,
    select,
    true,
)
from sqlalchemy.orm import Mapped, Session, mapped_column

from rtron.service.domain.schemas import IncidentPage, IncidentSummary, StoredIncident
from rtron.service.store.notices import IncidentNotice, post_notice
from rtron.service.store.tables import RobotRow, Table
from rtron.wire.common.incident_report import IncidentReport, encode_report, report_document

INCIDENT_MESSAGE = {"type": "incident"}
"""The live message that a robot has told of another incident."""
MAX_ROBOT_INCIDENTS = 200
"""So many incidents of a robot are kept at most, the newest."""
MAX_ROBOT_BYTES = 8 << 20
"""What the reports of a robot may take together, bytes."""


class IncidentRow(Table):
    """An incident that a robot has reported; `bytes` is how long the report is."""

    __tablename__ = "incidents"
    __table_args__ = (
        UniqueConstraint("robot_id", "name"),
        Index("incidents_by_robot", "robot_id", "id"),
        Index("incidents_by_stored", "stored"),
    )

    id: Mapped[int] = mapped_column(
        BigInteger().with_variant(Integer(), "sqlite"), primary_key=True
    )
    robot_id: Mapped[int] = mapped_column(ForeignKey("robots.id"))
    name: Mapped[str] = mapped_column(String(130))
    stored: Mapped[int]
    bytes: Mapped[int]
    summary: Mapped[dict[str, Any]]
    report: Mapped[dict[str, Any]]


def add_incident(session: Session, robot_id: int, report: IncidentReport, now: int) -> bool:
    """Keep a report, and forget the robot's oldest; return whether there was none of its name."""
    is_same = (IncidentRow.robot_id == robot_id) & (IncidentRow.name == report.name)
    if session.scalar(select(IncidentRow.id).where(is_same)) is not None:
        return False
    row = IncidentRow(
        robot_id=robot_id,
        name=report.name,
        stored=now,
        bytes=len(encode_report(report)),
        summary=_summary(report),
        report=report_document(report),
    )
    session.add(row)
    session.flush()
    _delete_excess(session, MAX_ROBOT_BYTES, robot_id)
    post_notice(session, IncidentNotice())
    return True


def incident_page(
    session: Session, robot: str | None, before: int | None, limit: int
) -> IncidentPage:
    """Return at most `limit` incidents, newest first; of robots nobody knows there are none."""
    row = IncidentRow
    query = select(row.id, RobotRow.name.label("robot"), row.name, row.stored, row.summary)
    query = query.join(RobotRow, RobotRow.id == row.robot_id)
    if robot is not None:
        query = query.where(RobotRow.name == robot)
    if before is not None:
        query = query.where(row.id < before)
    found = session.execute(query.order_by(row.id.desc()).limit(limit + 1)).all()
    incidents = [
        IncidentSummary(id=id, robot=of, name=name, stored=stored, **summary)
        for id, of, name, stored, summary in found[:limit]
    ]
    return IncidentPage(incidents=incidents, next=incidents[-1].id if len(found) > limit else None)


def find_incident(session: Session, robot: str, name: str) -> StoredIncident | None:
    """Return an incident of a robot by the name of its file; None if there is none."""
    query = select(IncidentRow).join(RobotRow, RobotRow.id == IncidentRow.robot_id)
    row = session.scalar(query.where(RobotRow.name == robot, IncidentRow.name == name))
    return StoredIncident(robot=robot, stored=row.stored, report=row.report) if row else None


def prune_incidents(session: Session, cutoff: int, max_bytes: int) -> None:
    """Delete what was stored before `cutoff` (ns), and the oldest above so many bytes."""
    session.execute(delete(IncidentRow).where(IncidentRow.stored < cutoff))
    _delete_excess(session, max_bytes)


def _delete_excess(session: Session, max_bytes: int, robot_id: int | None = None) -> None:
    """Delete the oldest of all incidents, or those of a robot, above what may be kept."""
    newest_first = IncidentRow.id.desc()
    is_meant = true() if robot_id is None else IncidentRow.robot_id == robot_id
    ranked = (
        select(
            IncidentRow.id,
            func.sum(IncidentRow.bytes).over(order_by=newest_first).label("total"),
            func.row_number().over(order_by=newest_first).label("rank"),
        )
        .where(is_meant)
        .subquery()
    )
    is_excess = ranked.c.total > max_bytes
    if robot_id is not None:
        is_excess = or_(is_excess, ranked.c.rank > MAX_ROBOT_INCIDENTS)
    excess = session.scalars(select(ranked.c.id).where(is_excess)).all()
    if excess:
        session.execute(delete(IncidentRow).where(IncidentRow.id.in_(excess)))


def _summary(report: IncidentReport) -> dict[str, Any]:
    """Return what a list shows of a report."""
    gravest = report.gravest
    return {
        "at": report.at,
        "app": report.app,
        "size": report.size,
        "revision": report.revision,
        "kind": gravest.kind,
        "topic": gravest.topic,
        "flow": gravest.flow,
        "reason": gravest.reason,
        "owner": report.owner,
        "publisher": report.publisher,
        "causes": len(report.causes) + report.omitted_causes,
    }
