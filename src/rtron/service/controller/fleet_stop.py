"""An emergency stop of many robots: one transaction for all, then one round of messages.

Each by itself would wait for the disk once for each robot.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from sqlalchemy.orm import Session

from rtron.errors import RTronError
from rtron.service.controller.robot_snapshot import active_settings, no_hello_error
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.principal import Principal, reach_error
from rtron.service.domain.revisions import add_stop, is_same_stop
from rtron.service.domain.schemas import SettingsOutcome, SettingsView
from rtron.service.store.audit import record_events, record_repeatable
from rtron.service.store.database import Database
from rtron.service.store.fleet.labels import labels_by_robot
from rtron.service.store.robots import RobotFilter, list_robots
from rtron.service.store.settings import (
    ChangeAuthor,
    add_all_settings,
    announce_all_settings,
    newest_settings_by_app,
    settings_view,
    with_settings,
)
from rtron.service.store.tables import AppRow, SettingsRow
from rtron.vocabulary import Settings

Failures: TypeAlias = dict[str, RTronError]
"""Why robots are not stopped, or their stops not stored."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetStop:
    """Whoever stops which robots, and why."""

    caller: Principal
    robots: Collection[str]
    reason: str

    def within_reach(self, database: Database) -> tuple["FleetStop", Failures]:
        """Return the stop of the robots that are in a group of the caller, and why not of others.

        Where the caller is limited to none, nothing is asked of the database.
        """
        if self.caller.groups is None:
            return self, {}
        with database.session() as session:
            robots = [robot for robot, _ in list_robots(session, RobotFilter(within=self.robots))]
            labels = labels_by_robot(session, [robot.id for robot in robots])
        labels_by_name = {robot.name: labels[robot.id] for robot in robots}
        failures: Failures = {
            robot: error
            for robot in self.robots
            if (error := reach_error(self.caller, robot, labels_by_name.get(robot, ())))
        }
        near = [robot for robot in self.robots if robot not in failures]
        return replace(self, robots=near), failures

    def event(self, robot: str) -> AuditEvent:
        """Return what the audit log says of it."""
        return self.caller.audit_event("stop", robot, reason=self.reason)


@dataclass(slots=True, kw_only=True)
class StoredStops:
    """What is stored and has to go out, what is not, and what takes more than a stop: `singly`."""

    sent: Mapping[str, tuple[Settings, SettingsView]] = field(default_factory=dict)
    failures: Failures = field(default_factory=dict)
    singly: Collection[str] = ()


def store_stops(session: Session, stop: FleetStop, now: int, steady_now: int) -> StoredStops:
    """Store a stop of each robot as a new revision, unless the same one is in force there.

    Those whose guards have refused their newest settings are left to be stopped alone.
    """
    apps = {robot.name: app for robot, app in list_robots(session, RobotFilter(within=stop.robots))}
    newest = newest_settings_by_app(session, [app.id for app in apps.values() if app])
    rows = {name: (app, newest[app.id]) for name, app in apps.items() if app and app.id in newest}
    singly = {name for name, (_, row) in rows.items() if row.error}
    again = {name for name, (_, row) in rows.items() if _is_in_force(stop, row)}
    new = {name: each for name, each in rows.items() if name not in singly | again}
    sent = _add_revisions(session, stop, new, now, steady_now)
    failures: Failures = {
        robot: no_hello_error(robot) if robot in apps else NotFoundError("there is no such robot")
        for robot in stop.robots
        if robot not in rows
    }
    for robot in again:
        record_repeatable(session, now, stop.event(robot), "done")
    record_failures(session, stop, failures, now)
    return StoredStops(sent=sent, failures=failures, singly=singly)


def record_failures(session: Session, stop: FleetStop, failures: Failures, now: int) -> None:
    """Write into the audit log why robots are not stopped."""
    for robot, error in failures.items():
        record_repeatable(session, now, stop.event(robot), f"refused: {error}")


def _is_in_force(stop: FleetStop, row: SettingsRow) -> bool:
    settings = active_settings(row, row.at)
    is_applied = row.outcome == SettingsOutcome.APPLIED
    return bool(
        is_applied and settings.stop and is_same_stop(settings.stop, stop.caller.name, stop.reason)
    )


def _add_revisions(
    session: Session,
    stop: FleetStop,
    robots: Mapping[str, tuple[AppRow, SettingsRow]],
    now: int,
    steady_now: int,
) -> dict[str, tuple[Settings, SettingsView]]:
    after = {
        name: add_stop(active_settings(row, steady_now), stop.caller.name, stop.reason, now)
        for name, (_, row) in robots.items()
    }
    author = ChangeAuthor(by=stop.caller.name, reason=stop.reason, at=steady_now)
    made = add_all_settings(
        session, {robots[name][0].id: settings for name, settings in after.items()}, author
    )
    rows = {name: made[app.id] for name, (app, _) in robots.items()}
    events = [with_settings(stop.event(name), robots[name][0], row) for name, row in rows.items()]
    record_events(session, now, events)
    announce_all_settings(session, rows)
    return {name: (after[name], settings_view(row)) for name, row in rows.items()}
