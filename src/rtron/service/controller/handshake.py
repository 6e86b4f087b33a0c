"""The hello of a guard: what is stored of it, and the settings that answer it."""

from collections import deque
from dataclasses import dataclass, replace

from sqlalchemy.orm import Session

from rtron.coherence import EffectivePlan
from rtron.errors import InputError, WireError
from rtron.planning.plan_file.fields import IDENTIFIER
from rtron.reports.app.risks_json import risks_to_json
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.plan_json import plan_digest, plan_json
from rtron.service.domain.planned_graph import planned_graph
from rtron.service.domain.risk_model import build_risk_models, planned_nodes
from rtron.service.domain.settings_checks import drop_misfits
from rtron.service.store.audit import record_event
from rtron.service.store.events import check_run
from rtron.service.store.graphs import find_graph, stored_risks
from rtron.service.store.robots import (
    count_apps,
    find_app,
    find_robot,
    register_robot,
    replace_risk_models,
)
from rtron.service.store.settings import (
    ChangeAuthor,
    add_settings,
    load_settings,
    newest_settings,
    with_settings,
)
from rtron.service.store.tables import AppRow, RobotRow, SettingsRow
from rtron.vocabulary import SECOND, EmergencyStop, Plan, Settings
from rtron.wire.common.link_protocol import Hello
from rtron.workflows.scan import scan_graph

MAX_APPS = 100
"""The most apps of one robot."""
MAX_NODES = 1000
"""The most coordination nodes of one plan."""
_MAX_REVISION = 1 << 50
_MAX_TEXT = 200
_SERVICE_ACTOR = "rtron"
_MAX_LISTED = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Handshake:
    """The row of the settings that a guard is to put in force, and whether they are new.

    `is_changed`: the robot's app, its plan or the settings are others than before.
    """

    row: SettingsRow
    is_new: bool
    is_changed: bool


def perform_handshake(session: Session, robot: str, hello: Hello, now: int) -> Handshake:
    """Store a robot's app, plan and coordination nodes, those of a hello that is not odd."""
    return _HandshakeTransaction(session, robot, hello, now).run()


def is_known(session: Session, robot: str, hello: Hello) -> bool:
    """Tell whether the app, the plan and the revision of a hello are those that are stored."""
    _, app = find_robot(session, robot) or (None, None)
    if app is None or app.name != hello.app or app.digest != plan_digest(plan_json(hello.plan)):
        return False
    row = newest_settings(session, app.id)
    return row is not None and hello.revision <= row.revision


def store_risk_models(session: Session, app: AppRow, plan: Plan, settings: Settings) -> None:
    """Store the risk models of an app's coordination nodes, with these settings in force."""
    effective = EffectivePlan(plan, settings)
    models = build_risk_models(plan, effective.plan, app_risks(session, app, plan))
    replace_risk_models(session, app.id, models)


def app_risks(session: Session, app: AppRow, plan: Plan) -> list[dict[str, object]]:
    """Return the risks of the uploaded graph, or else those that the plan itself shows."""
    if find_graph(session, app.id):
        return list(stored_risks(session, app.id))
    risks: list[dict[str, object]] = risks_to_json(scan_graph(planned_graph(plan)).report)["risks"]
    return risks


def check_hello(hello: Hello) -> None:
    """Raise WireError for what no guard sends: it would not fit into the database, or a console."""
    nodes = [node for _, node in planned_nodes(hello.plan)]
    ids = {node.id for node in nodes}
    check_run(hello.run)
    if len(hello.app) > _MAX_TEXT or "\0" in hello.app or not 0 <= hello.revision < _MAX_REVISION:
        raise WireError("the guard's app or revision is none")
    if len(nodes) > MAX_NODES or len(ids) < len(nodes) or not all(map(IDENTIFIER.matches, ids)):
        raise WireError("the coordination nodes of the guard's plan have no ids of their own")
    if max(map(len, ids), default=0) > _MAX_TEXT:
        raise WireError(f"the id of a coordination node is longer than {_MAX_TEXT} characters")


def _truncated(stop: EmergencyStop | None) -> EmergencyStop | None:
    return stop and replace(stop, by=stop.by[:_MAX_TEXT], reason=stop.reason[:_MAX_TEXT])


@dataclass(frozen=True, slots=True)
class _HandshakeTransaction:
    """One hello of a robot's guard at `now` (ns), in one transaction."""

    session: Session
    robot: str
    hello: Hello
    now: int

    def run(self) -> Handshake:
        robot = register_robot(self.session, self.robot, self.now)
        app, is_changed = self._find_app(robot)
        previous_app_id, robot.app_id = robot.app_id, app.id
        previous = newest_settings(self.session, app.id)
        row = previous or self._add_settings(app, Settings(), "the plan")
        if is_changed:
            facts = {"app": app.name, "digest": app.digest, "dry_run": self.hello.dry_run}
            record_event(self.session, self.now, self._event("plan", **facts))
            row = self._drop_misfits(app, row)
        if previous_app_id not in (None, app.id):
            row = self._copy_stop(app, row, newest_settings(self.session, previous_app_id))
        row = self._raise_revision(app, row)
        if is_changed:
            store_risk_models(self.session, app, self.hello.plan, load_settings(row))
        is_new = row is not previous
        is_changed = is_changed or is_new or previous_app_id != app.id
        return Handshake(row=row, is_new=is_new, is_changed=is_changed)

    def _find_app(self, robot: RobotRow) -> tuple[AppRow, bool]:
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
        if count_apps(self.session, robot) >= MAX_APPS:
            raise InputError(f"{robot.name} has had {MAX_APPS} apps")
        return AppRow(robot_id=robot.id, name=self.hello.app, created=self.now, digest="")

    def _drop_misfits(self, app: AppRow, row: SettingsRow) -> SettingsRow:
        """Leave out of the settings what no longer fits the plan."""
        remaining, dropped = drop_misfits(self.hello.plan, load_settings(row))
        if not dropped:
            return row
        details = "; ".join(dropped[:_MAX_LISTED])
        after = replace(remaining, revision=row.revision + 1)
        return self._add_settings(app, after, f"the plan has changed, left out: {details}")

    def _raise_revision(self, app: AppRow, row: SettingsRow) -> SettingsRow:
        """Go above the guard's revision where the database has lost it: a guard never goes back.

        Of the guard's settings only an emergency stop counts, so that an older copy of the database
        ends none; nobody has been asked whether a guard may set the rest.
        """
        if self.hello.revision <= row.revision:
            return row
        settings, guard_stop = load_settings(row), self.hello.settings.stop
        after = replace(
            settings, revision=self.hello.revision + 1, stop=settings.stop or _truncated(guard_stop)
        )
        reason = f"the guard had revision {self.hello.revision}, which was not in the database"
        return self._add_settings(app, after, reason)

    def _copy_stop(
        self, app: AppRow, row: SettingsRow, previous: SettingsRow | None
    ) -> SettingsRow:
        """Take over the emergency stop, or its end, of the app before: it is the robot's."""
        settings, stop = load_settings(row), load_settings(previous).stop if previous else None
        if settings.stop == stop:
            return row
        after = replace(settings, revision=row.revision + 1, stop=stop)
        reason = "the robot is stopped" if stop else "the emergency stop has been ended meanwhile"
        return self._add_settings(app, after, f"{reason}, under another app")

    def _add_settings(self, app: AppRow, settings: Settings, reason: str) -> SettingsRow:
        author = ChangeAuthor(by=_SERVICE_ACTOR, reason=reason, at=self.now)
        row = add_settings(self.session, app.id, settings, author)
        event = self._event("settings", revision=settings.revision, reason=reason)
        record_event(self.session, self.now, with_settings(event, app, row))
        return row

    def _event(self, action: str, **detail: object) -> AuditEvent:
        return AuditEvent(
            who=f"guard:{self.robot}", action=action, target=self.robot, detail=detail
        )


MAX_HELLOS_PER_MINUTE = 10
"""The most hellos of one robot within a minute that change its app, its plan or its settings."""
_MINUTE = 60 * SECOND


class HelloRateLimit:
    """Counts such hellos of each robot; not for several threads at once."""

    def __init__(self) -> None:
        self._times: dict[str, deque[int]] = {}

    def count(self, robot: str, now: int) -> None:
        """Count one at `now` (ns, a steady clock); InputError if there were too many."""
        times = self._times.setdefault(robot, deque(maxlen=MAX_HELLOS_PER_MINUTE))
        if len(times) == MAX_HELLOS_PER_MINUTE and now - times[0] < _MINUTE:
            message = f"more than {MAX_HELLOS_PER_MINUTE} hellos within a minute "
            message += "that change the app or the plan"
            raise InputError(message, help="do several guards have this robot's token?")
        times.append(now)
