"""A robot as the database has it at this moment: its app, its plan, its newest settings."""

from dataclasses import dataclass, replace

from sqlalchemy.orm import Session

from rtron.coherence import compatible_settings
from rtron.service.domain.alarms import Acknowledgement
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.revisions import StaleRevisionError
from rtron.service.domain.schemas import RobotSummary, SettingsOutcome
from rtron.service.live.live_robots import LiveRobot, LiveRobots
from rtron.service.store.fleet.labels import labels_by_robot, labels_of
from rtron.service.store.robots import RobotFilter, find_robot, list_robots, load_plan
from rtron.service.store.settings import (
    last_applied_settings,
    load_settings,
    newest_settings,
    newest_settings_by_app,
    settings_view,
)
from rtron.service.store.shifts import acknowledgements_in_force
from rtron.service.store.tables import AppRow, RobotRow, SettingsRow
from rtron.vocabulary import SECOND, Plan, Settings

_MAX_CLOCK_DIFFERENCE = 60 * SECOND
"""So far the clocks of two services on one database may differ, ns."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotSnapshot:
    """A robot with its current app; `row` are its newest settings, `settings` what they say."""

    robot: str
    app: AppRow
    plan: Plan
    row: SettingsRow
    settings: Settings

    def check_newest(self, revision: int) -> None:
        """Raise StaleRevisionError if that is not the newest revision."""
        if revision != self.row.revision:
            raise StaleRevisionError(settings_view(self.row))

    def differs(self, after: Settings) -> bool:
        """Tell whether a change makes a difference; what the guard refused may be tried again."""
        return bool(self.row.error) or after.nodes != self.settings.nodes


def load_snapshot(session: Session, robot: str) -> RobotSnapshot:
    """Return what is known of a robot; NotFoundError while no guard of it has said hello."""
    app = load_current_app(session, robot)
    row = newest_settings(session, app.id)
    if row is None:
        raise no_hello_error(robot)
    return RobotSnapshot(
        robot=robot, app=app, plan=load_plan(app), row=row, settings=load_settings(row)
    )


def load_current_app(session: Session, robot: str) -> AppRow:
    """Return the current app of a robot; NotFoundError while no guard of it has said hello."""
    match = find_robot(session, robot)
    if match is None:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    if match[1] is None:
        raise no_hello_error(robot)
    return match[1]


def last_accepted_settings(session: Session, snapshot: RobotSnapshot) -> Settings:
    """Return the newest settings; if the guard has refused them, with the nodes it last took.

    Of those the ones that the plan still has.
    """
    if not snapshot.row.error:
        return snapshot.settings
    applied = last_applied_settings(session, snapshot.app.id)
    accepted, _ = compatible_settings(
        snapshot.plan, load_settings(applied) if applied else Settings()
    )
    return replace(snapshot.settings, nodes=accepted.nodes, plan=accepted.plan)


def active_settings(row: SettingsRow, now: int) -> Settings:
    """Return the settings of a row without overrides that are over at `now` (ns).

    Where they were made in the future the clock was set back since, before this service began:
    nobody knows what is left of their overrides, so they are over.
    """
    return drop_expired_overrides(load_settings(row), row.at, now)


def drop_expired_overrides(settings: Settings, made_at: int, now: int) -> Settings:
    """Return settings that were made at `made_at` (ns) without overrides that are over."""
    is_known = made_at <= now + _MAX_CLOCK_DIFFERENCE
    active = {id: each for id, each in settings.overrides.items() if is_known and each.until > now}
    return replace(settings, overrides=active)


def no_hello_error(robot: str) -> NotFoundError:
    """Return the error for a robot that nothing can be set for yet."""
    help = "start its guard: rtron guard --service URL --token-file FILE"
    return NotFoundError(f"no guard of {robot} has said hello yet", help=help)


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
