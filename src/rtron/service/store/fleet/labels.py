"""Labels of robots; the robots with one label are a group."""

from collections.abc import Collection, Mapping, Sequence

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from rtron.service.store.tables import RobotLabelRow, RobotRow

MAX_LABELS = 20
"""The most labels of one robot."""


def labels_of(session: Session, robot: str) -> frozenset[str]:
    """Return the labels of a robot; none for one that is not known."""
    query = select(RobotLabelRow.label).join(RobotRow).where(RobotRow.name == robot)
    return frozenset(session.scalars(query))


def labels_by_robot(session: Session, robot_ids: Collection[int]) -> Mapping[int, frozenset[str]]:
    """Return the labels of each of these robots, by its id."""
    query = select(RobotLabelRow).where(RobotLabelRow.robot_id.in_(robot_ids))
    labels: dict[int, set[str]] = {id: set() for id in robot_ids}
    for row in session.scalars(query):
        labels[row.robot_id].add(row.label)
    return {id: frozenset(each) for id, each in labels.items()}


def replace_labels(session: Session, robot: RobotRow, labels: Collection[str]) -> None:
    """Make these the labels of a robot."""
    session.execute(delete(RobotLabelRow).where(RobotLabelRow.robot_id == robot.id))
    session.add_all(RobotLabelRow(robot_id=robot.id, label=label) for label in sorted(set(labels)))


def replace_members(session: Session, group: str, robot_ids: Collection[int]) -> None:
    """Make these robots the ones with a label."""
    session.execute(delete(RobotLabelRow).where(RobotLabelRow.label == group))
    session.add_all(RobotLabelRow(robot_id=id, label=group) for id in robot_ids)


def group_sizes(session: Session) -> Sequence[tuple[str, int]]:
    """Return each group by name, and how many robots it has."""
    label = RobotLabelRow.label
    query = select(label, func.count()).group_by(label).order_by(label)
    return [(name, size) for name, size in session.execute(query)]
