"""A new roll-out: which robots, whether each of them can take the change, and in which order."""

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy.orm import Session

from rtron.errors import InputError, RTronError
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal, check_reach
from rtron.service.domain.revisions import apply_change
from rtron.service.domain.rollouts.decisions import spread_kinds
from rtron.service.domain.rollouts.plans import check_plan_change, check_plan_right
from rtron.service.domain.rollouts.schemas import (
    MAX_ROBOTS,
    NewRollout,
    RobotSelection,
    RolloutState,
)
from rtron.service.domain.schemas import SettingsChange
from rtron.service.store.fleet.labels import labels_by_robot
from rtron.service.store.fleet.rollout_tables import RolloutRow
from rtron.service.store.fleet.rollouts import (
    active_rollouts_of,
    add_plan_document,
    add_rollout,
    add_rollout_robots,
)
from rtron.service.store.robots import RobotFilter, list_robots, load_plan
from rtron.service.store.settings import load_settings, newest_settings_by_app
from rtron.service.store.tables import AppRow, RobotRow
from rtron.vocabulary import Plan, Settings
from rtron.wire.common.link_protocol import plan_document_digest
from rtron.workflows.plan import read_checked_plan

_MAX_NAMED = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectedRobot:
    """A robot, its app, its newest settings, and its labels."""

    robot: RobotRow
    app: AppRow
    settings: Settings
    labels: frozenset[str]


def start_rollout(session: Session, caller: Principal, new: NewRollout, now: int) -> RolloutRow:
    """Store a roll-out; it begins by itself.

    NotFoundError where no robot is meant, ConflictError where another roll-out has one of them,
    InputError and ForbiddenError where one of them could not take the change from the caller.
    """
    robots = _select(session, new.robots)
    digest = _store_plan(session, new.plan) if new.plan else None
    check_change(caller, robots, new.nodes, new.plan, new.reason)
    if taken := active_rollouts_of(session, [each.robot.id for each in robots]):
        name, other = min(taken.items())
        help = "wait until it is done, or cancel it"
        raise ConflictError(f"{name} is in roll-out {other} already", help=help)
    policy = new.policy.model_dump(mode="json")
    rollout = add_rollout(
        session,
        RolloutRow(
            by=caller.name,
            reason=new.reason,
            nodes=new.nodes,
            plan=digest,
            policy=policy,
            created=now,
            changed=now,
            state=RolloutState.RUNNING,
            note="",
            stage=0,
        ),
    )
    add_rollout_robots(session, rollout, _in_order(robots, rollout.id))
    return rollout


def check_change(
    caller: Principal,
    robots: Sequence[SelectedRobot],
    nodes: dict[str, dict[str, object]],
    plan: str | None,
    reason: str,
) -> None:
    """Raise unless the caller may make a change on each of the robots, and each can take it.

    Robots with one plan and the same settings are looked at once.
    """
    new_plan = read_checked_plan(plan) if plan else None
    checked: set[tuple[str, str]] = set()
    for each in robots:
        check_reach(caller, each.robot.name, each.labels)
        key = (each.app.digest, repr(each.settings.nodes))
        if key not in checked:
            checked.add(key)
            change = SettingsChange(revision=each.settings.revision, nodes=nodes, reason=reason)
            _check_one(caller, each, new_plan or change)


def selected_robots(
    session: Session, matches: Sequence[tuple[RobotRow, AppRow | None]]
) -> list[SelectedRobot]:
    """Return robots with what a change of them is checked against; those without app are left."""
    found = [(robot, app) for robot, app in matches if app is not None]
    rows = newest_settings_by_app(session, [app.id for _, app in found])
    labels = labels_by_robot(session, [robot.id for robot, _ in found])
    return [
        SelectedRobot(
            robot=robot, app=app, settings=load_settings(rows[app.id]), labels=labels[robot.id]
        )
        for robot, app in found
        if app.id in rows
    ]


def _select(session: Session, selection: RobotSelection) -> list[SelectedRobot]:
    chosen = RobotFilter(within=selection.names, label=selection.label, app=selection.app)
    robots = selected_robots(session, list_robots(session, chosen))
    if missing := set(selection.names or ()) - {each.robot.name for each in robots}:
        names = ", ".join(sorted(missing)[:_MAX_NAMED])
        raise NotFoundError(f"no guard of {names} has said hello", help="leave them out")
    if not robots:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    if len(robots) > MAX_ROBOTS:
        raise InputError(f"{len(robots)} robots, the most is {MAX_ROBOTS}", help="choose a label")
    return robots


def _check_one(caller: Principal, robot: SelectedRobot, change: SettingsChange | Plan) -> None:
    try:
        if isinstance(change, Plan):
            check_plan_right(caller)
            check_plan_change(load_plan(robot.app), change)
        else:
            apply_change(load_plan(robot.app), robot.settings, caller.roles, change)
    except (InputError, ForbiddenError) as error:
        raise _named(robot.robot.name, error) from None


def _store_plan(session: Session, text: str) -> str:
    digest = plan_document_digest(text)
    add_plan_document(session, digest, text)
    return digest


def _named(robot: str, error: RTronError) -> RTronError:
    kind = ForbiddenError if isinstance(error, ForbiddenError) else InputError
    return kind(f"{robot}: {error}", help=error.help)


def _in_order(robots: Sequence[SelectedRobot], seed: int) -> list[int]:
    ids = {each.robot.name: each.robot.id for each in robots}
    kinds = {each.robot.name: (each.app.digest, each.labels) for each in robots}
    return [ids[name] for name in spread_kinds(kinds, seed)]
