"""What stored events tell of problems of robots: for each robot and kind one look into an index."""

from collections.abc import Iterator, Mapping

from sqlalchemy import ColumnElement, Select, and_, func, literal, select, union_all
from sqlalchemy.orm import Session

from rtron.service.domain.rollouts.schemas import Problem, RobotPhase
from rtron.service.store.fleet.rollout_tables import RolloutRobotRow
from rtron.service.store.tables import EventRow
from rtron.vocabulary import EventKind

_KINDS = {Problem.ALARM: EventKind.ALARM, Problem.STOPPED: EventKind.STOP}


def newest_event(session: Session, robot_id: int) -> tuple[int, str]:
    """Return the id of a robot's newest event, and its guard's run; 0 and "" if it has none."""
    query = select(EventRow.id, EventRow.run).where(EventRow.robot_id == robot_id)
    row = session.execute(query.order_by(EventRow.id.desc()).limit(1)).first()
    return (row[0], row[1]) if row else (0, "")


def recent_problems(session: Session, robot_id: int, since: int) -> frozenset[Problem]:
    """Return the problems of which a robot has told since a time (ns)."""
    return frozenset(
        problem
        for problem, kind in _KINDS.items()
        if (_newest_stored(session, robot_id, kind) or 0) >= since
    )


def problems_since_change(
    session: Session, rollout_id: int, restarts: int = 0
) -> Mapping[int, frozenset[Problem]]:
    """Return, by id, which problems the robots of a roll-out have told since they got the change.

    A robot is not in there while it has told none. So many `restarts` of its guard are none.
    """
    found: dict[int, set[Problem]] = {}
    for robot_id, problem in session.execute(union_all(*_queries(rollout_id, restarts))):
        found.setdefault(robot_id, set()).add(Problem(problem))
    return {robot_id: frozenset(problems) for robot_id, problems in found.items()}


def _newest_stored(session: Session, robot_id: int, kind: EventKind) -> int | None:
    query = select(EventRow.stored).where(EventRow.robot_id == robot_id, EventRow.kind == kind)
    return session.scalar(query.order_by(EventRow.id.desc()).limit(1))


def _queries(rollout_id: int, restarts: int) -> Iterator[Select[int, str]]:
    for problem, kind in _KINDS.items():
        yield _query(rollout_id, problem, EventRow.kind == kind.value)
    is_other_run = and_(EventRow.run != RolloutRobotRow.run, RolloutRobotRow.run != "")
    has_begun = and_(EventRow.kind == EventKind.GUARD.value, is_other_run)
    yield _query(rollout_id, Problem.RESTARTED, has_begun, restarts)


def _query(
    rollout_id: int, problem: Problem, condition: ColumnElement[bool], runs: int = 0
) -> Select[int, str]:
    """Select the robots with an event for which a condition holds; of more `runs` than so many."""
    robot = RolloutRobotRow
    events = select(EventRow.id).where(
        EventRow.robot_id == robot.robot_id, EventRow.id > robot.event_id, condition
    )
    if runs:
        several = func.count(EventRow.run.distinct()) > runs
        events = events.with_only_columns(literal(1)).group_by(EventRow.robot_id).having(several)
    return select(robot.robot_id, literal(problem.value)).where(
        robot.rollout_id == rollout_id,
        robot.phase.in_((RobotPhase.SENDING, RobotPhase.SENT)),
        events.exists(),
    )
