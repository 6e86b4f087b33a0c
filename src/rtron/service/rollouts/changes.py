"""Each robot's change in a roll-out: an ordinary revision of its settings, made and taken back."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from rtron.coherence import EffectivePlan
from rtron.errors import InputError, RTronError
from rtron.service.controller.risk_controller import RiskController
from rtron.service.controller.robot_snapshot import RobotSnapshot, load_snapshot
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.principal import (
    TOKEN_ROLES,
    AccessScope,
    Principal,
    check_reach,
    group_set,
)
from rtron.service.domain.revisions import StaleRevisionError
from rtron.service.domain.rollouts.plans import (
    check_plan_change,
    check_plan_right,
    plan_without_change,
    with_plan,
    without_plan,
)
from rtron.service.domain.rollouts.schemas import Problem, RobotPhase, RolloutState
from rtron.service.domain.schemas import SettingsChange, SettingsView
from rtron.service.store.accounts.tokens import is_valid
from rtron.service.store.accounts.users import find_user, roles_of
from rtron.service.store.database import Database
from rtron.service.store.fleet.labels import labels_of
from rtron.service.store.fleet.rollout_tables import RolloutRobotRow, RolloutRow
from rtron.service.store.fleet.rollouts import (
    RobotOfRollout,
    find_plan_document,
    get_rollout,
    set_note,
    set_state,
)
from rtron.service.store.settings import load_settings, load_settings_document
from rtron.service.store.tables import TokenRow
from rtron.workflows.plan import read_checked_plan

_ACTOR = "rtron"
_PREFIX = "token:"
log = logging.getLogger(__name__)

_STATES_WITHOUT_RIGHTS = {
    RolloutState.RUNNING: RolloutState.PAUSED,
    RolloutState.DONE: RolloutState.CANCELLED,
}
"""What a roll-out comes to when who began it may not change a robot any more."""


@dataclass(frozen=True, slots=True)
class _Result:
    """What came of a robot's change: at `waiting` it is tried again."""

    phase: RobotPhase
    revision: int | None = None
    problem: Problem | None = None
    note: str = ""


@dataclass(frozen=True, slots=True)
class RobotChanges:
    """Makes and takes back the changes of roll-outs."""

    database: Database
    controller: RiskController
    clock: Clock

    def send(self, rollout: RolloutRow, robots: Sequence[RobotOfRollout], now: int) -> None:
        """Make the change on robots whose settings before are stored.

        It takes the rights that who began the roll-out has now; without them it is paused.
        """
        if not robots:
            return
        with self.database.session() as session:
            caller = _find_caller(session, rollout.by, now)
        results: dict[int, _Result] = {}
        try:
            for each in robots:
                results[each.row.robot_id] = self._send_one(caller, rollout, each.name)
        except ForbiddenError as error:
            self._pause(rollout.id, str(error))
        waiting = _Result(RobotPhase.WAITING)
        self._store(rollout.id, {each.row.robot_id: waiting for each in robots} | results)

    def revert(self, rollout: RolloutRow, robots: Sequence[RobotOfRollout]) -> None:
        """Put in force again, on each robot, what was so before the change."""
        if robots:
            self._store(
                rollout.id, {each.row.robot_id: self._revert_one(rollout, each) for each in robots}
            )

    def _send_one(self, caller: Principal, rollout: RolloutRow, robot: str) -> _Result:
        with self.database.session() as session:
            check_reach(caller, robot, labels_of(session, robot))
            revision = load_snapshot(session, robot).row.revision
        reason = _reason(rollout, rollout.reason)
        try:
            if rollout.plan:
                view = self._send_plan(caller, robot, rollout.plan, reason)
            else:
                change = SettingsChange(revision=revision, nodes=rollout.nodes, reason=reason)
                view = self.controller.change(caller, robot, change)
        except StaleRevisionError:
            return _Result(RobotPhase.WAITING)
        except (InputError, NotFoundError) as error:
            return _Result(RobotPhase.SENT, problem=Problem.REFUSED, note=str(error))
        return _Result(RobotPhase.SENT, view.revision)

    def _send_plan(self, caller: Principal, robot: str, digest: str, reason: str) -> SettingsView:
        """Let settings name another plan; the robot fetches it."""

        def apply(session: Session, snapshot: RobotSnapshot) -> EffectivePlan | None:
            check_plan_right(caller)
            new = read_checked_plan(find_plan_document(session, digest) or "")
            check_plan_change(snapshot.plan, new)
            after = with_plan(snapshot.settings, new, digest)
            return EffectivePlan(snapshot.plan, after) if after else None

        event = caller.audit_event("settings", robot, plan=digest, reason=reason)
        return self.controller.revise(robot, event, apply, reason)

    def _revert_one(self, rollout: RolloutRow, robot: RobotOfRollout) -> _Result:
        before = load_settings_document(robot.row.before or {})
        reason = _reason(rollout, "taken back")
        detail = {"reason": reason}
        event = AuditEvent(
            who=_ACTOR, action="settings.take_back", target=robot.name, detail=detail
        )

        def take_back(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan | None:
            if snapshot.app.id != robot.row.app_id:
                raise ConflictError("it has another app now", help="look at its settings")
            if rollout.plan:
                sent = load_settings(snapshot.row).plan
                after = without_plan(snapshot.settings, sent, rollout.plan, before.plan)
                return EffectivePlan(snapshot.plan, after) if after else None
            return plan_without_change(snapshot.plan, before, rollout.nodes, snapshot.settings)

        try:
            view = self.controller.revise(robot.name, event, take_back, reason)
        except RTronError as error:
            log.warning("%s: roll-out %d cannot be taken back", robot.name, rollout.id)
            return _Result(RobotPhase.STUCK, note=str(error))
        return _Result(RobotPhase.REVERTED, view.revision)

    def _pause(self, id: int, why: str) -> None:
        with self.database.write_session() as session:
            rollout = get_rollout(session, id)
            state = _STATES_WITHOUT_RIGHTS.get(RolloutState(rollout.state))
            if state:
                set_state(rollout, state, why, self.clock())

    def _store(self, id: int, results: dict[int, _Result]) -> None:
        with self.database.write_session() as session:
            for robot_id, result in results.items():
                row = session.get_one(RolloutRobotRow, (id, robot_id))
                row.phase, row.revision = result.phase, result.revision
                if result.problem:
                    row.problems = sorted({*row.problems, result.problem})
                set_note(row, result.note)


def _reason(rollout: RolloutRow, reason: str) -> str:
    return f"roll-out {rollout.id}: {reason}"[:200]


def _find_caller(session: Session, name: str, now: int) -> Principal:
    """Return a user or a token by name, without a role if it is disabled, over or not there."""
    if name.startswith(_PREFIX):
        return _token_caller(session, name, now)
    user = find_user(session, name)
    if user is None or user.disabled:
        return Principal(name=name, roles=frozenset())
    roles = roles_of(user)
    return Principal(name=name, roles=roles, groups=group_set(user.groups, roles))


def _token_caller(session: Session, name: str, now: int) -> Principal:
    query = select(TokenRow).where(TokenRow.name == name.removeprefix(_PREFIX))
    token = session.scalar(query)
    if token is None or not is_valid(token, now):
        return Principal(name=name, roles=frozenset())
    scopes = map(AccessScope, token.scopes)
    roles = frozenset(TOKEN_ROLES[scope] for scope in scopes if scope in TOKEN_ROLES)
    return Principal(name=name, roles=roles, groups=group_set(token.groups, roles))
