"""What robots of a roll-out show before the change and after it, kept with each of them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from sqlalchemy.orm import Session

from rtron.service.controller.robot_snapshot import load_snapshot
from rtron.service.domain.rollouts.observations import Observation, baseline_of, find_problems
from rtron.service.domain.rollouts.schemas import Problem, RobotPhase, RolloutPolicy
from rtron.service.domain.schemas import SettingsOutcome
from rtron.service.store.fleet.rollouts import (
    RobotOfRollout,
    load_baseline,
    newest_event,
    problems_since_change,
    recent_problems,
    store_baseline,
)
from rtron.service.store.settings import settings_json
from rtron.vocabulary import SECOND, GuardState

_MIN_RECENT_S = 60.0


def begin_watching(
    session: Session,
    robot: RobotOfRollout,
    state: GuardState | None,
    policy: RolloutPolicy,
    now: int,
) -> None:
    """Keep what a robot is set to and shows before it gets the change; once, as it comes first."""
    row = robot.row
    if row.phase != RobotPhase.WAITING or state is None:
        return
    snapshot = load_snapshot(session, robot.name)
    since = now - round(max(policy.wait, _MIN_RECENT_S) * SECOND)
    row.phase, row.sent_at, row.app_id = RobotPhase.SENDING, now, snapshot.app.id
    row.before = settings_json(snapshot.settings)
    row.event_id, row.run = newest_event(session, row.robot_id)
    store_baseline(row, baseline_of(state, recent_problems(session, row.robot_id, since)))


def note_problems(
    session: Session,
    robots: Sequence[RobotOfRollout],
    states: Mapping[str, GuardState],
    policy: RolloutPolicy,
    now: int,
    *,
    is_plan: bool,
) -> None:
    """Keep with each robot that has the change the problems that it shows, and has shown."""
    watched = [each for each in robots if each.row.phase in {RobotPhase.SENDING, RobotPhase.SENT}]
    restarts = 1 if is_plan else 0  # that of the plan itself
    events = problems_since_change(session, watched[0].row.rollout_id, restarts) if watched else {}
    for each in watched:
        state = states.get(each.name)
        _note_missing(each, is_missing=state is None or _is_unanswered(each), now=now)
        observation = Observation(
            state=state,
            events=events.get(each.row.robot_id, frozenset()),
            is_refused=each.outcome is SettingsOutcome.REFUSED,
            missing_since=each.row.missing_since,
        )
        found = find_problems(
            replace(load_baseline(each.row), is_counted_anew=is_plan),
            observation,
            policy.blocked_rise,
            round(policy.answer_within * SECOND),
            now,
        )
        _add_problems(each, found)


def _note_missing(robot: RobotOfRollout, *, is_missing: bool, now: int) -> None:
    if is_missing and robot.row.missing_since is None:
        robot.row.missing_since = now
    elif not is_missing and robot.row.missing_since is not None:
        robot.row.missing_since = None


def _is_unanswered(robot: RobotOfRollout) -> bool:
    return robot.outcome is SettingsOutcome.PENDING


def _add_problems(robot: RobotOfRollout, found: frozenset[Problem]) -> None:
    known = frozenset(map(Problem, robot.row.problems))
    if not found <= known:
        robot.row.problems = sorted(known | found)
