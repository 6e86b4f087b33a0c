"""Robots, their apps, and the risk model of the coordination nodes (paper section 6.3)."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session, defer

from rtron.service.domain.plan_json import parse_plan
from rtron.service.domain.risk_model import RiskModel
from rtron.service.store.tables import AppRow, CoordinationNodeRow, RobotLabelRow, RobotRow
from rtron.vocabulary import Plan


def load_plan(app: AppRow) -> Plan:
    """Return the plan of an app."""
    return parse_plan(app.plan)


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFilter:
    """Robots after a name, whose name contains `text`, of an app, with a label, of a set or not."""

    after: str = ""
    limit: int | None = None
    text: str = ""
    app: str | None = None
    label: str | None = None
    within: Collection[str] | None = None
    without: Collection[str] = ()


def list_robots(
    session: Session, robot_filter: RobotFilter | None = None
) -> Sequence[tuple[RobotRow, AppRow | None]]:
    """Return robots by name, each with its current app, whose plan is loaded when it is asked."""
    chosen, name = robot_filter or RobotFilter(), RobotRow.name
    query = select(RobotRow, AppRow).outerjoin(AppRow, AppRow.id == RobotRow.app_id)
    query = query.options(defer(AppRow.plan))
    query = query.where(name > chosen.after, name.contains(chosen.text, autoescape=True))
    query = query.where(name.not_in(chosen.without))
    if chosen.app is not None:
        query = query.where(AppRow.name == chosen.app)
    if chosen.label is not None:
        labelled = select(RobotLabelRow.robot_id).where(RobotLabelRow.label == chosen.label)
        query = query.where(RobotRow.id.in_(labelled))
    if chosen.within is not None:
        query = query.where(name.in_(chosen.within))
    rows = session.execute(query.order_by(name).limit(chosen.limit))
    return [(robot, app) for robot, app in rows]


def find_robot(session: Session, name: str) -> tuple[RobotRow, AppRow | None] | None:
    """Return a robot and its current app; None if there is no such robot."""
    query = (
        select(RobotRow, AppRow)
        .outerjoin(AppRow, AppRow.id == RobotRow.app_id)
        .where(RobotRow.name == name)
    )
    match = session.execute(query).first()
    return (match[0], match[1]) if match else None


def register_robot(session: Session, name: str, now: int) -> RobotRow:
    """Return the robot, made if it is new; it was seen at `now` (ns)."""
    robot = session.scalars(select(RobotRow).where(RobotRow.name == name)).one_or_none()
    if robot is None:
        robot = RobotRow(name=name, created=now, seen=now, app_id=None)
        session.add(robot)
    robot.seen = now
    session.flush()
    return robot


def count_apps(session: Session, robot: RobotRow) -> int:
    """Return how many apps a robot has had."""
    query = select(func.count()).select_from(AppRow).where(AppRow.robot_id == robot.id)
    return session.scalars(query).one()


def find_app(session: Session, robot: RobotRow, name: str) -> AppRow | None:
    """Return an app of a robot."""
    query = select(AppRow).where(AppRow.robot_id == robot.id, AppRow.name == name)
    return session.scalars(query).one_or_none()


def coordination_nodes(session: Session, app_id: int) -> Sequence[CoordinationNodeRow]:
    """Return the coordination nodes of an app in the plan's order."""
    query = (
        select(CoordinationNodeRow)
        .where(CoordinationNodeRow.app_id == app_id)
        .order_by(CoordinationNodeRow.position)
    )
    return session.scalars(query).all()


def replace_risk_models(session: Session, app_id: int, models: Sequence[RiskModel]) -> None:
    """Make these the coordination nodes of an app; when they were triggered stays known."""
    rows_by_node = {row.node: row for row in coordination_nodes(session, app_id)}
    _delete_nodes(session, app_id, rows_by_node.keys() - {model.node for model in models})
    for position, model in enumerate(models):
        row = rows_by_node.get(model.node) or _new_node(session, app_id, model.node)
        row.position = position
        row.type = model.type
        row.description = model.description
        row.risk_information = model.risk_information
        row.policy_settings = model.policy_settings
    session.flush()


def store_policy_settings(
    session: Session, app_id: int, settings: Mapping[str, dict[str, Any]]
) -> None:
    """Keep what is in force at the coordination nodes of an app, by their ids."""
    for row in coordination_nodes(session, app_id):
        if row.node in settings and row.policy_settings != settings[row.node]:
            row.policy_settings = settings[row.node]


def _new_node(session: Session, app_id: int, node: str) -> CoordinationNodeRow:
    row = CoordinationNodeRow(app_id=app_id, node=node, triggered=None, violation=None)
    session.add(row)
    return row


def _delete_nodes(session: Session, app_id: int, nodes: Iterable[str]) -> None:
    removed = list(nodes)
    if removed:
        session.execute(
            delete(CoordinationNodeRow).where(
                CoordinationNodeRow.app_id == app_id, CoordinationNodeRow.node.in_(removed)
            )
        )
