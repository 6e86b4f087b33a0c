"""A robot in short: what the database knows of it, and what its guard is at now."""

from sqlalchemy.orm import Session

from rtron.service.domain.alarms import Acknowledgement
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.schemas import RobotSummary, SettingsOutcome
from rtron.service.live.live_robots import LiveRobot, LiveRobots
from rtron.service.store.acknowledgements import acknowledgements_in_force
from rtron.service.store.fleet.labels import labels_by_robot, labels_of
from rtron.service.store.robots import RobotFilter, find_robot, list_robots
from rtron.service.store.settings import load_settings, newest_settings, newest_settings_by_app
from rtron.service.store.tables import AppRow, RobotRow, SettingsRow


def list_robot_summaries(
    session: Session, live: LiveRobots, robot_filter: RobotFilter
) -> list[RobotSummary]:
    """Return robots by name."""
    robots = list_robots(session, robot_filter)
    rows = newest_settings_by_app(session, [app.id for _, app in robots if app])
    now = live.find(session, [robot.name for robot, _ in robots])
    seen = acknowledgements_in_force(session)
    labels = labels_by_robot(session, [robot.id for robot, _ in robots])
    return [
        _summary(
            now[robot.name],
            robot,
            labels[robot.id],
            app,
            rows.get(app.id) if app else None,
            seen.get(robot.name, ()),
        )
        for robot, app in robots
    ]


def get_robot_summary(session: Session, live: LiveRobots, name: str) -> RobotSummary:
    """Return one robot; NotFoundError if there is none of that name."""
    match = find_robot(session, name)
    if match is None:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    robot, app = match
    now = live.find(session, [name])[name]
    acknowledged = acknowledgements_in_force(session, [robot.id]).get(name, ())
    row = newest_settings(session, app.id) if app else None
    return _summary(now, robot, labels_of(session, name), app, row, acknowledged)


def _summary(
    now: LiveRobot,
    robot: RobotRow,
    labels: frozenset[str],
    app: AppRow | None,
    row: SettingsRow | None,
    acknowledged: tuple[Acknowledgement, ...],
) -> RobotSummary:
    state = now.state
    return RobotSummary(
        name=robot.name,
        labels=sorted(labels),
        app=app.name if app else None,
        ros=app.ros if app else None,
        connected=now.connected,
        seen=robot.seen,
        dry_run=now.dry_run,
        revision=row.revision if row else 0,
        outcome=SettingsOutcome(row.outcome) if row else None,
        stop=load_settings(row).stop if row else None,
        dropped=now.dropped,
        alarms=state.alarms if state else (),
        acknowledged=acknowledged,
        overridden=state.overridden if state else (),
        stopped=state.stopped if state else False,
        requests=state.requests.count if state and state.requests else 0,
        state=state,
    )
