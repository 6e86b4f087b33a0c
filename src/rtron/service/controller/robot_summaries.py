"""A robot in short: what the database knows of it, and what its guard is at now."""

from typing import Protocol

from sqlalchemy.orm import Session

from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.schemas import RobotSummary, SettingsOutcome
from rtron.service.store.robots import find_robot, robots
from rtron.service.store.settings import newest, newest_of_all, settings_of
from rtron.service.store.tables import AppRow, RobotRow, SettingsRow
from rtron.vocabulary import GuardState


class Live(Protocol):
    """What is known of guards at this moment."""

    def connected(self, robot: str) -> bool:
        """Tell whether the robot's guard is connected."""

    def state(self, robot: str) -> GuardState | None:
        """Return what the robot's guard is at."""

    def dropped(self, robot: str) -> int:
        """Return how many events of the robot are lost."""

    def dry_run(self, robot: str) -> bool:
        """Tell whether the robot's guard forbids nothing."""


def summaries(session: Session, live: Live) -> list[RobotSummary]:
    """Return all robots by name."""
    rows = newest_of_all(session)
    return [
        _summary(live, robot, app, rows.get(app.id) if app else None)
        for robot, app in robots(session)
    ]


def summary(session: Session, live: Live, name: str) -> RobotSummary:
    """Return one robot; NotFoundError if there is none of that name."""
    found = find_robot(session, name)
    if found is None:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    robot, app = found
    return _summary(live, robot, app, newest(session, app.id) if app else None)


def _summary(
    live: Live, robot: RobotRow, app: AppRow | None, row: SettingsRow | None
) -> RobotSummary:
    return RobotSummary(
        name=robot.name,
        app=app.name if app else None,
        ros=app.ros if app else None,
        connected=live.connected(robot.name),
        seen=robot.seen,
        dry_run=live.dry_run(robot.name),
        revision=row.revision if row else 0,
        outcome=SettingsOutcome(row.outcome) if row else None,
        stop=settings_of(row).stop if row else None,
        dropped=live.dropped(robot.name),
        state=live.state(robot.name),
    )
