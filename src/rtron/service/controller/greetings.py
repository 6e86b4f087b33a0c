"""What is stored when a guard says hello, and which settings it is to put in force."""

from dataclasses import dataclass, replace

from sqlalchemy.orm import Session

from rtron.errors import InputError, WireError
from rtron.planning.form import WORD
from rtron.reports.app.risks_json import risks_to_json
from rtron.risks import discover
from rtron.service.controller.app_graph import planned_graph
from rtron.service.controller.checks import still_fitting
from rtron.service.controller.known import unexpired
from rtron.service.controller.risk_model import coordination, risk_models
from rtron.service.store.audit import Deed, record
from rtron.service.store.graphs import find_graph, stored_risks
from rtron.service.store.robots import (
    count_apps,
    find_app,
    meet_robot,
    plan_digest,
    plan_json,
    store_models,
)
from rtron.service.store.settings_rows import Author, add, newest, settings_of
from rtron.service.store.tables import AppRow, RobotRow, SettingsRow
from rtron.vocabulary import EmergencyStop, Plan, Settings, effective
from rtron.wire.link import Hello

MOST_APPS = 100
"""The most apps of one robot."""
MOST_NODES = 1000
"""The most coordination nodes of one plan."""
_MOST_REVISION = 1 << 50
_LONGEST_APP = 200
_SERVICE = "rtron"
_TOLD = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Greeted:
    """The settings that a guard is to put in force, their row, and whether they are new.

    `is_changed`: the robot's app, its plan or the settings are others than before.
    """

    settings: Settings
    row: SettingsRow
    is_new: bool
    is_changed: bool


def greeted(session: Session, robot: str, hello: Hello, now: int) -> Greeted:
    """Store a robot's app, plan and coordination nodes, those of a hello that is not odd."""
    return _Meeting(session, robot, hello, now).greeted()


def store_risk_models(session: Session, app: AppRow, plan: Plan, settings: Settings) -> None:
    """Store the risk models of an app's coordination nodes, with these settings in force."""
    models = risk_models(plan, effective(plan, settings), app_risks(session, app, plan))
    store_models(session, app.id, models)


def app_risks(session: Session, app: AppRow, plan: Plan) -> list[dict[str, object]]:
    """Return the risks of the uploaded graph, or else those that the plan itself shows."""
    if find_graph(session, app.id):
        return list(stored_risks(session, app.id))
    found: list[dict[str, object]] = risks_to_json(discover(planned_graph(plan)))["risks"]
    return found


def refuse_odd(hello: Hello) -> None:
    """Raise WireError for what no guard sends: it would not fit into the database, or a console."""
    nodes = [node for _, node in coordination(hello.plan)]
    ids = {node.id for node in nodes}
    if len(hello.app) > _LONGEST_APP or not 0 <= hello.revision < _MOST_REVISION:
        raise WireError("the guard's app or revision is none")
    if len(nodes) > MOST_NODES or len(ids) < len(nodes) or not all(map(WORD.fits, ids)):
        raise WireError("the coordination nodes of the guard's plan have no ids of their own")
    if max(map(len, ids), default=0) > _LONGEST_APP:
        raise WireError(f"the id of a coordination node is longer than {_LONGEST_APP} characters")


def _short(stop: EmergencyStop | None) -> EmergencyStop | None:
    return stop and replace(stop, by=stop.by[:_LONGEST_APP], reason=stop.reason[:_LONGEST_APP])


@dataclass(frozen=True, slots=True)
class _Meeting:
    """One hello of a robot's guard at `now` (ns), in one transaction."""

    session: Session
    robot: str
    hello: Hello
    now: int

    def greeted(self) -> Greeted:
        robot = meet_robot(self.session, self.robot, self.now)
        app, is_changed = self._app(robot)
        last, robot.app_id = robot.app_id, app.id
        before = newest(self.session, app.id)
        row = before or self._add(app, Settings(), "the plan")
        if is_changed:
            self._note("plan", app=app.name, digest=app.digest, dry_run=self.hello.dry_run)
            row = self._fitted(app, row)
        if last not in (None, app.id):
            row = self._stopped_as(app, row, newest(self.session, last))
        row = self._above(app, row)
        if is_changed:
            store_risk_models(self.session, app, self.hello.plan, settings_of(row))
        settings = unexpired(settings_of(row), self.now)
        is_new = row is not before
        is_changed = is_changed or is_new or last != app.id
        return Greeted(settings=settings, row=row, is_new=is_new, is_changed=is_changed)

    def _app(self, robot: RobotRow) -> tuple[AppRow, bool]:
        """Return the app with its plan, and whether either is new."""
        document = plan_json(self.hello.plan)
        digest = plan_digest(document)
        app = find_app(self.session, robot, self.hello.app) or self._new_app(robot)
        if app.digest == digest:
            return app, False
        app.plan, app.digest, app.ros = document, digest, self.hello.plan.ros
        app.changed = self.now
        self.session.add(app)
        self.session.flush()
        return app, True

    def _new_app(self, robot: RobotRow) -> AppRow:
        if count_apps(self.session, robot) >= MOST_APPS:
            raise InputError(f"{robot.name} has had {MOST_APPS} apps")
        return AppRow(robot_id=robot.id, name=self.hello.app, created=self.now, digest="")

    def _fitted(self, app: AppRow, row: SettingsRow) -> SettingsRow:
        """Leave out of the settings what no longer fits the plan."""
        left, lost = still_fitting(self.hello.plan, settings_of(row))
        if not lost:
            return row
        told = "; ".join(lost[:_TOLD])
        after = replace(left, revision=row.revision + 1)
        return self._add(app, after, f"the plan has changed, left out: {told}")

    def _above(self, app: AppRow, row: SettingsRow) -> SettingsRow:
        """Go above the guard's revision where the database has lost it: a guard never goes back.

        Of the guard's settings only an emergency stop counts, so that an older copy of the database
        ends none; nobody has been asked whether a guard may set the rest.
        """
        if self.hello.revision <= row.revision:
            return row
        known, theirs = settings_of(row), self.hello.settings.stop
        after = replace(known, revision=self.hello.revision + 1, stop=known.stop or _short(theirs))
        told = f"the guard had revision {self.hello.revision}, which was not in the database"
        return self._add(app, after, told)

    def _stopped_as(self, app: AppRow, row: SettingsRow, last: SettingsRow | None) -> SettingsRow:
        """Take over the emergency stop, or its end, of the app before: it is the robot's."""
        known, stop = settings_of(row), settings_of(last).stop if last else None
        if known.stop == stop:
            return row
        after = replace(known, revision=row.revision + 1, stop=stop)
        told = "the robot is stopped" if stop else "the emergency stop has been ended meanwhile"
        return self._add(app, after, f"{told}, under another app")

    def _add(self, app: AppRow, settings: Settings, reason: str) -> SettingsRow:
        self._note("settings", revision=settings.revision, reason=reason)
        author = Author(by=_SERVICE, reason=reason, at=self.now)
        return add(self.session, app.id, settings, author)

    def _note(self, action: str, **detail: object) -> None:
        deed = Deed(who=f"guard:{self.robot}", action=action, target=self.robot, detail=detail)
        record(self.session, self.now, deed)
