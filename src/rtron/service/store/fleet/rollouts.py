"""Roll-outs and their robots; what guards have answered is looked up in the settings."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from pydantic import TypeAdapter
from sqlalchemy import ColumnElement, Select, and_, func, literal, or_, select, union_all
from sqlalchemy.orm import Session

from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.rollouts.observations import RobotBaseline
from rtron.service.domain.rollouts.schemas import (
    ACTIVE_STATES,
    Problem,
    RobotPhase,
    RolloutPolicy,
    RolloutState,
)
from rtron.service.domain.schemas import SettingsOutcome
from rtron.service.store.database import Database
from rtron.service.store.fleet.rollout_tables import PlanDocumentRow, RolloutRobotRow, RolloutRow
from rtron.service.store.tables import EventRow, RobotRow, SettingsRow
from rtron.vocabulary import EventKind

_ADVISORY_LOCK_KEY = 0x7274726F6C
CATCH_UP = 30 * 86_400_000_000_000
"""So long after its end a roll-out reaches robots that were off, ns."""
_BASELINE = TypeAdapter(RobotBaseline)
_MAX_NOTE, _MAX_ROBOT_NOTE = 1000, 300


@dataclass(frozen=True, slots=True)
class RobotOfRollout:
    """A robot of a roll-out, its name, and what its guard has answered to the change."""

    name: str
    row: RolloutRobotRow
    outcome: SettingsOutcome | None
    error: str


@contextmanager
def rollout_turn(database: Database) -> Iterator[bool]:
    """Give whether this process takes roll-outs further: of several replicas, one at a time."""
    if database.is_sqlite:
        yield True
        return
    with database.session() as session:
        query = select(func.pg_try_advisory_xact_lock(_ADVISORY_LOCK_KEY))
        yield bool(session.scalar(query))


def add_rollout(session: Session, rollout: RolloutRow) -> RolloutRow:
    """Store a new roll-out, which gets its id."""
    session.add(rollout)
    session.flush()
    return rollout


def add_plan_document(session: Session, digest: str, text: str) -> None:
    """Keep a plan document, once."""
    if session.get(PlanDocumentRow, digest) is None:
        session.add(PlanDocumentRow(digest=digest, text=text))
        session.flush()


def find_plan_document(session: Session, digest: str) -> str | None:
    """Return a plan document by its digest."""
    row = session.get(PlanDocumentRow, digest)
    return row.text if row else None


def add_rollout_robots(session: Session, rollout: RolloutRow, robot_ids: Sequence[int]) -> None:
    """Store the robots of a roll-out in the order in which they get the change."""
    session.add_all(
        RolloutRobotRow(
            rollout_id=rollout.id,
            robot_id=robot_id,
            position=position,
            phase=RobotPhase.WAITING,
            problems=[],
            note="",
        )
        for position, robot_id in enumerate(robot_ids)
    )
    session.flush()


def get_rollout(session: Session, id: int) -> RolloutRow:
    """Return a roll-out; NotFoundError if there is none of that id."""
    row = session.get(RolloutRow, id)
    if row is None:
        raise NotFoundError(f"there is no roll-out {id}", help="GET /api/v1/rollouts lists them")
    return row


def list_rollouts(session: Session, before: int | None, limit: int) -> Sequence[RolloutRow]:
    """Return roll-outs, newest first, those older than `before`."""
    query = select(RolloutRow).order_by(RolloutRow.id.desc()).limit(limit)
    return session.scalars(query if before is None else query.where(RolloutRow.id < before)).all()


def unfinished_rollouts(session: Session, now: int) -> Sequence[int]:
    """Return the roll-outs, oldest first, of which something may be left to do at `now` (ns)."""
    robot = RolloutRobotRow
    is_late = and_(robot.phase != RobotPhase.REVERTED, robot.sent_at > RolloutRow.changed)
    left = select(robot.robot_id).where(
        robot.rollout_id == RolloutRow.id, or_(robot.phase == RobotPhase.WAITING, is_late)
    )
    is_catching_up = and_(
        RolloutRow.state == RolloutState.DONE, RolloutRow.changed > now - CATCH_UP, left.exists()
    )
    query = select(RolloutRow.id).where(or_(RolloutRow.state.in_(ACTIVE_STATES), is_catching_up))
    return session.scalars(query.order_by(RolloutRow.id)).all()


def robots_of_rollout(
    session: Session, id: int, *, after: int = -1, limit: int | None = None
) -> Sequence[RobotOfRollout]:
    """Return robots of a roll-out in order, those after a position."""
    row = RolloutRobotRow
    is_same = and_(SettingsRow.app_id == row.app_id, SettingsRow.revision == row.revision)
    query = (
        select(RobotRow.name, row, SettingsRow.outcome, SettingsRow.error)
        .join(RobotRow, RobotRow.id == row.robot_id)
        .outerjoin(SettingsRow, is_same)
        .where(row.rollout_id == id, row.position > after)
        .order_by(row.position)
        .limit(limit)
    )
    return [
        RobotOfRollout(name, each, SettingsOutcome(outcome) if outcome else None, error or "")
        for name, each, outcome, error in session.execute(query)
    ]


def count_phases(session: Session, ids: Collection[int]) -> Mapping[int, Mapping[str, int]]:
    """Return how many robots of each of these roll-outs are at each phase."""
    row = RolloutRobotRow
    query = select(row.rollout_id, row.phase, func.count()).where(row.rollout_id.in_(ids))
    counts: dict[int, dict[str, int]] = {id: {} for id in ids}
    for id, phase, count in session.execute(query.group_by(row.rollout_id, row.phase)):
        counts[id][phase] = count
    return counts


def active_rollouts_of(session: Session, robot_ids: Collection[int]) -> Mapping[str, int]:
    """Return by name those of the robots that are in an active roll-out, with its id."""
    row = RolloutRobotRow
    query = (
        select(RobotRow.name, row.rollout_id)
        .join(RobotRow, RobotRow.id == row.robot_id)
        .join(RolloutRow, RolloutRow.id == row.rollout_id)
        .where(row.robot_id.in_(robot_ids), RolloutRow.state.in_(ACTIVE_STATES))
    )
    return dict(session.execute(query).all())


def set_state(rollout: RolloutRow, state: RolloutState, note: str, now: int) -> None:
    """Let a roll-out come to a state at `now` (ns); `note` says why."""
    rollout.state, rollout.note, rollout.changed = state, note[:_MAX_NOTE], now


def set_note(row: RolloutRobotRow, note: str) -> None:
    """Say what is to be known of a robot."""
    row.note = note[:_MAX_ROBOT_NOTE]


def load_policy(rollout: RolloutRow) -> RolloutPolicy:
    """Return how a roll-out goes out."""
    return RolloutPolicy.model_validate(rollout.policy)


def load_baseline(row: RolloutRobotRow) -> RobotBaseline:
    """Return what a robot showed before the change."""
    return _BASELINE.validate_python(row.baseline) if row.baseline else RobotBaseline()


def store_baseline(row: RolloutRobotRow, baseline: RobotBaseline) -> None:
    """Keep what a robot shows before the change."""
    row.baseline = _BASELINE.dump_python(baseline, mode="json")


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
