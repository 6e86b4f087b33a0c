"""A robot in short: what the database knows of it, and what its guard is at now."""

from sqlalchemy.orm import Session

from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.schemas import RobotSummary, SettingsOutcome
from rtron.service.live.hub import Hub
from rtron.service.store.robots import find_robot, list_robots
from rtron.service.store.settings import load_settings, newest_settings, newest_settings_by_app
from rtron.service.store.tables import AppRow, RobotRow, SettingsRow


def list_robot_summaries(session: Session, hub: Hub) -> list[RobotSummary]:
    """Return all robots by name."""
    rows = newest_settings_by_app(session)
    return [
        _summary(hub, robot, app, rows.get(app.id) if app else None)
        for robot, app in list_robots(session)
    ]


def get_robot_summary(session: Session, hub: Hub, name: str) -> RobotSummary:
    """Return one robot; NotFoundError if there is none of that name."""
    match = find_robot(session, name)
    if match is None:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    robot, app = match
    return _summary(hub, robot, app, newest_settings(session, app.id) if app else None)


def _summary(
    hub: Hub, robot: RobotRow, app: AppRow | None, row: SettingsRow | None
) -> RobotSummary:
    return RobotSummary(
        name=robot.name,
        app=app.name if app else None,
        ros=app.ros if app else None,
        connected=hub.is_connected(robot.name),
        seen=robot.seen,
        dry_run=hub.is_dry_run(robot.name),
        revision=row.revision if row else 0,
        outcome=SettingsOutcome(row.outcome) if row else None,
        stop=load_settings(row).stop if row else None,
        dropped=hub.lost_event_count(robot.name),
        state=hub.state(robot.name),
    )
