"""A robot as the database has it at this moment: its app, its plan, its newest settings."""

from dataclasses import dataclass, replace

from sqlalchemy.orm import Session

from rtron.coherence import compatible_settings
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.revisions import StaleRevisionError
from rtron.service.store.robots import find_robot, load_plan
from rtron.service.store.settings import (
    last_applied_settings,
    load_settings,
    newest_settings,
    settings_view,
)
from rtron.service.store.tables import AppRow, SettingsRow
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
