"""A robot as the database has it at this moment: its app, its plan, its newest settings."""

from dataclasses import dataclass, replace

from sqlalchemy.orm import Session

from rtron.service.domain.errors import NotFoundError
from rtron.service.store.robots import find_robot, plan_of
from rtron.service.store.settings import last_applied, newest, settings_of
from rtron.service.store.tables import AppRow, SettingsRow
from rtron.vocabulary import Plan, Settings, fitting


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """A robot with its current app; `row` are its newest settings, `settings` what they say."""

    robot: str
    app: AppRow
    plan: Plan
    row: SettingsRow
    settings: Settings


def find_known(session: Session, robot: str) -> Known:
    """Return what is known of a robot; NotFoundError while no guard of it has said hello."""
    app = find_current_app(session, robot)
    row = newest(session, app.id)
    if row is None:
        raise _unmet(robot)
    return Known(robot=robot, app=app, plan=plan_of(app), row=row, settings=settings_of(row))


def find_current_app(session: Session, robot: str) -> AppRow:
    """Return the current app of a robot; NotFoundError while no guard of it has said hello."""
    found = find_robot(session, robot)
    if found is None:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    if found[1] is None:
        raise _unmet(robot)
    return found[1]


def last_good(session: Session, known: Known) -> Settings:
    """Return the newest settings; if the guard has refused them, with the nodes it last took.

    Of those the ones that the plan still has.
    """
    if not known.row.error:
        return known.settings
    applied = last_applied(session, known.app.id)
    taken, _ = fitting(known.plan, settings_of(applied) if applied else Settings())
    return replace(known.settings, nodes=taken.nodes)


def unexpired(settings: Settings, now: int) -> Settings:
    """Return the settings without overrides that are over at `now` (ns)."""
    left = {id: each for id, each in settings.overrides.items() if each.until > now}
    return replace(settings, overrides=left)


def _unmet(robot: str) -> NotFoundError:
    help = "start its guard: rtron guard --service URL --token-file FILE"
    return NotFoundError(f"no guard of {robot} has said hello yet", help=help)
