"""A roll-out that people pause, resume and cancel, and what they see of it."""

from collections import Counter
from collections.abc import Collection, Mapping
from typing import Any

from sqlalchemy.orm import Session

from rtron.service.domain.errors import ConflictError
from rtron.service.domain.principal import Principal, check_reach
from rtron.service.domain.rollouts.decisions import stage_targets
from rtron.service.domain.rollouts.schemas import (
    Problem,
    RobotPhase,
    RolloutCancellation,
    RolloutPage,
    RolloutRobot,
    RolloutRobotPage,
    RolloutState,
    RolloutSummary,
    RolloutView,
)
from rtron.service.domain.schemas import SettingsOutcome
from rtron.service.rollouts.start import SelectedRobot, check_change, selected_robots
from rtron.service.store.fleet.labels import labels_by_robot
from rtron.service.store.fleet.rollout_tables import RolloutRow
from rtron.service.store.fleet.rollouts import (
    RobotOfRollout,
    count_phases,
    find_plan_document,
    get_rollout,
    list_rollouts,
    load_policy,
    robots_of_rollout,
    set_state,
)
from rtron.service.store.robots import RobotFilter, list_robots

_PAUSABLE = {RolloutState.RUNNING}
_RESUMABLE = {RolloutState.PAUSED}
_CANCELLABLE = {RolloutState.RUNNING, RolloutState.PAUSED, RolloutState.DONE}


def pause_rollout(session: Session, caller: Principal, id: int, reason: str, now: int) -> None:
    """Let no further robot get the change; whoever may change its robots may do that."""
    rollout = _in_state(session, id, _PAUSABLE)
    robots = robots_of_rollout(session, id)
    labels = labels_by_robot(session, [each.row.robot_id for each in robots])
    for each in robots:
        check_reach(caller, each.name, labels[each.row.robot_id])
    set_state(rollout, RolloutState.PAUSED, f"{caller.name}: {reason}", now)


def resume_rollout(session: Session, caller: Principal, id: int, reason: str, now: int) -> None:
    """Go on; it takes the rights of making the change."""
    rollout = _in_state(session, id, _RESUMABLE)
    _check_again(session, caller, rollout)
    set_state(rollout, RolloutState.RUNNING, f"{caller.name}: {reason}", now)


def cancel_rollout(
    session: Session, caller: Principal, id: int, request: RolloutCancellation, now: int
) -> None:
    """End a roll-out: the change goes back, or stays where it is; it takes the rights of it."""
    rollout = _in_state(session, id, _CANCELLABLE)
    _check_again(session, caller, rollout)
    state = RolloutState.CANCELLED if request.keep else RolloutState.REVERTING
    set_state(rollout, state, f"{caller.name}: {request.reason}", now)


def rollout_page(session: Session, before: int | None, limit: int) -> RolloutPage:
    """Return roll-outs, newest first, those older than `before`."""
    rows = list_rollouts(session, before, limit + 1)
    page = rows[:limit]
    counts = count_phases(session, [each.id for each in page])
    summaries = [RolloutSummary(**_summary(each, Counter(counts[each.id]))) for each in page]
    return RolloutPage(rollouts=summaries, next=page[-1].id if len(rows) > limit else None)


def rollout_view(session: Session, id: int) -> RolloutView:
    """Return a roll-out in full."""
    rollout, robots = get_rollout(session, id), robots_of_rollout(session, id)
    policy = load_policy(rollout)
    problems = Counter(Problem(name) for each in robots for name in each.row.problems)
    return RolloutView(
        **_summary(rollout, Counter(each.row.phase for each in robots)),
        nodes=rollout.nodes,
        plan=rollout.plan,
        policy=policy,
        targets=list(stage_targets(policy.stages, len(robots))),
        problems=dict(problems),
        applied=sum(_is_in_force(each) for each in robots),
    )


def rollout_robot_page(session: Session, id: int, after: int, limit: int) -> RolloutRobotPage:
    """Return robots of a roll-out in order, those after a position."""
    get_rollout(session, id)
    robots = robots_of_rollout(session, id, after=after, limit=limit + 1)
    page = [_robot(each) for each in robots[:limit]]
    return RolloutRobotPage(robots=page, next=page[-1].position if len(robots) > limit else None)


def _in_state(session: Session, id: int, states: Collection[RolloutState]) -> RolloutRow:
    rollout = get_rollout(session, id)
    if rollout.state not in states:
        raise ConflictError(f"roll-out {id} is {rollout.state}", help="look at it again")
    return rollout


def _check_again(session: Session, caller: Principal, rollout: RolloutRow) -> None:
    plan = find_plan_document(session, rollout.plan) if rollout.plan else None
    check_change(caller, _selected(session, rollout.id), rollout.nodes, plan, rollout.reason)


def _selected(session: Session, id: int) -> list[SelectedRobot]:
    names = [each.name for each in robots_of_rollout(session, id)]
    return selected_robots(session, list_robots(session, RobotFilter(within=names)))


def _summary(rollout: RolloutRow, phases: Mapping[str, int]) -> dict[str, Any]:
    return {
        "id": rollout.id,
        "by": rollout.by,
        "reason": rollout.reason,
        "created": rollout.created,
        "changed": rollout.changed,
        "state": RolloutState(rollout.state),
        "note": rollout.note,
        "stage": rollout.stage,
        "total": sum(phases.values()),
        "waiting": phases.get(RobotPhase.WAITING, 0),
        "sent": phases.get(RobotPhase.SENDING, 0) + phases.get(RobotPhase.SENT, 0),
        "reverted": phases.get(RobotPhase.REVERTED, 0),
        "stuck": phases.get(RobotPhase.STUCK, 0),
    }


def _is_in_force(robot: RobotOfRollout) -> bool:
    return robot.row.phase == RobotPhase.SENT and robot.outcome is SettingsOutcome.APPLIED


def _robot(robot: RobotOfRollout) -> RolloutRobot:
    return RolloutRobot(
        robot=robot.name,
        position=robot.row.position,
        phase=RobotPhase(robot.row.phase),
        revision=robot.row.revision,
        outcome=robot.outcome,
        sent_at=robot.row.sent_at,
        problems=[Problem(name) for name in robot.row.problems],
        note=robot.row.note or robot.error,
    )
