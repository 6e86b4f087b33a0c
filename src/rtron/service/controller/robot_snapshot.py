"""A robot as the database has it at this moment: its app, its plan, its newest settings."""

from dataclasses import dataclass, replace

from sqlalchemy.orm import Session

from rtron.coherence import compatible_settings
from rtron.service.domain.errors import NotFoundError
from rtron.service.store.robots import find_robot, load_plan
from rtron.service.store.settings import last_applied_settings, load_settings, newest_settings
from rtron.service.store.tables import AppRow, SettingsRow
from rtron.vocabulary import Plan, Settings


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotSnapshot:
    """A robot with its current app; `row` are its newest settings, `settings` what they say."""

    robot: str
    app: AppRow
    plan: Plan
    row: SettingsRow
    settings: Settings


def load_snapshot(session: Session, robot: str) -> RobotSnapshot:
    """Return what is known of a robot; NotFoundError while no guard of it has said hello."""
    app = load_current_app(session, robot)
    row = newest_settings(session, app.id)
    if row is None:
        raise _no_hello_error(robot)
    return RobotSnapshot(
        robot=robot, app=app, plan=load_plan(app), row=row, settings=load_settings(row)
    )


def load_current_app(session: Session, robot: str) -> AppRow:
    """Return the current app of a robot; NotFoundError while no guard of it has said hello."""
    match = find_robot(session, robot)
    if match is None:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    if match[1] is None:
        raise _no_hello_error(robot)
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
    return replace(snapshot.settings, nodes=accepted.nodes)


def drop_expired_overrides(settings: Settings, now: int) -> Settings:
    """Return the settings without overrides that are over at `now` (ns)."""
    active = {id: each for id, each in settings.overrides.items() if each.until > now}
    return replace(settings, overrides=active)


def _no_hello_error(robot: str) -> NotFoundError:
    help = "start its guard: rtron guard --service URL --token-file FILE"
    return NotFoundError(f"no guard of {robot} has said hello yet", help=help)
