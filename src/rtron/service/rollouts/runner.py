"""Roll-outs go on: what guards report is looked at, then robots get the change, or lose it.

All of it is in the database, so that a service goes on where another one was killed. What a robot
has before the change is stored before the change is made.
"""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Hashable, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from rtron.errors import RTronError
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock
from rtron.service.domain.rollouts.decisions import (
    NextSteps,
    RobotProgress,
    RolloutProgress,
    next_steps,
    stage_targets,
)
from rtron.service.domain.rollouts.observations import (
    RolloutNews,
    going_back_alert,
    rollout_message,
)
from rtron.service.domain.rollouts.schemas import Problem, RobotPhase, RolloutPolicy, RolloutState
from rtron.service.domain.schemas import SettingsOutcome
from rtron.service.live.listener import LiveMessage
from rtron.service.live.live_robots import LiveRobots
from rtron.service.rollouts.changes import RobotChanges
from rtron.service.rollouts.watch import begin_watching, note_problems
from rtron.service.store.audit import record_event
from rtron.service.store.database import Database
from rtron.service.store.fleet.rollout_tables import RolloutRow
from rtron.service.store.fleet.rollouts import (
    RobotOfRollout,
    get_rollout,
    load_policy,
    robots_of_rollout,
    rollout_turn,
    set_state,
    unfinished_rollouts,
)
from rtron.service.store.notices import RolloutNotice, post_notice
from rtron.vocabulary import SECOND, GuardState

log = logging.getLogger(__name__)

_MIN_BATCH, _BATCHES = 20, 50
"""So many robots get or lose a change between two looks, and a large fleet in so many parts."""
PACE = 10 * SECOND
"""Within a stage a batch follows the one before after so long, or after `wait`, ns."""
_INTERVAL_S = 1.0
_ACTOR = "rtron"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Step:
    """What a roll-out is to do next, and what that was decided from."""

    rollout: RolloutRow
    policy: RolloutPolicy
    robots: Sequence[RobotOfRollout]
    states: Mapping[str, GuardState]
    next: NextSteps

    @property
    def is_idle(self) -> bool:
        """Whether there is nothing to do."""
        before = (self.rollout.state, self.rollout.stage)
        is_same = before == (self.next.state, self.next.stage)
        return is_same and not self.next.send and not self.next.revert

    @property
    def shown(self) -> Hashable:
        """What people see of it."""
        robots = [
            (each.row.phase, each.outcome, tuple(each.row.problems), each.row.note, each.error)
            for each in self.robots
        ]
        return self.rollout.state, self.rollout.stage, self.rollout.changed, tuple(robots)


@dataclass(frozen=True, slots=True)
class RolloutRunner:
    """Takes every roll-out a step further: one thread at a time, of all replicas."""

    database: Database
    changes: RobotChanges
    live: LiveRobots
    clock: Clock
    broadcast: Callable[[LiveMessage], None]
    _news: RolloutNews = field(default_factory=RolloutNews, init=False)

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Go on with roll-outs until the end of the block."""
        task = asyncio.create_task(self._run())
        try:
            yield
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)

    async def _run(self) -> None:
        while True:
            try:
                is_busy = await asyncio.to_thread(self.run_once)
            except (SQLAlchemyError, RTronError) as error:
                log.error("roll-outs do not go on: %s", type(error).__name__)  # noqa: TRY400
                is_busy = False
            await asyncio.sleep(0.0 if is_busy else _INTERVAL_S)

    def run_once(self) -> bool:
        """Take each roll-out a step further; return whether more can be done at once."""
        with rollout_turn(self.database) as is_ours:
            return is_ours and self._run_steps()

    def _run_steps(self) -> bool:
        with self.database.session() as session:
            ids = unfinished_rollouts(session, self.clock())
        is_busy = [self._run_step(id) for id in ids]
        for ended in self._news.take_ended(ids):
            self._announce(ended)
        return any(is_busy)

    def _run_step(self, id: int) -> bool:
        """Look, and do what is next; then tell who looks at it what is new."""
        now = self.clock()
        has_next, shown = self._look(id, now)
        is_busy, alert = self._take_step(id, now) if has_next else (False, "")
        if self._news.is_new(id, shown, now) or alert:
            self._announce(id, alert)
        return is_busy

    def _take_step(self, id: int, now: int) -> tuple[bool, str]:
        """Watch, decide and store that; then change the robots, each by a revision of its own.

        Return whether more can be done at once, and the alert if the roll-out goes back now.
        """
        with self.database.write_session() as session:
            step = self._decide(session, id, now)
            is_busy = not step.is_idle
            alert = _store_step(session, step, now)
            robots = {each.name: each for each in step.robots}
            sending = [robots[name] for name in step.next.send]
            for each in sending:
                begin_watching(session, each, step.states.get(each.name), step.policy, now)
        self.changes.send(step.rollout, sending, now)
        self.changes.revert(step.rollout, [robots[name] for name in step.next.revert])
        return is_busy, alert

    def _look(self, id: int, now: int) -> tuple[bool, Hashable]:
        """Return whether there is something to do, and what a roll-out shows.

        That holds nobody up who writes: most of the time there is nothing to do.
        """
        with self.database.session() as session, session.no_autoflush:
            step = self._decide(session, id, now)
            has_next = bool(session.dirty) or not step.is_idle
            shown = step.shown
            session.expunge_all()
        return has_next, shown

    def _announce(self, id: int, alert: str = "") -> None:
        """Tell the consoles of all replicas that something is new, and webhooks an alert."""
        if alert:
            log.error("%s", alert)
        with self.database.session() as session:
            post_notice(session, RolloutNotice(id=id, alert=alert))
        self.broadcast(rollout_message(id, alert))

    def _decide(self, session: Session, id: int, now: int) -> _Step:
        rollout, robots = get_rollout(session, id), robots_of_rollout(session, id)
        now_live = self.live.find(session, [each.name for each in robots])
        states = {name: each.state for name, each in now_live.items() if each.state}
        policy = load_policy(rollout)
        note_problems(session, robots, states, policy, now, is_plan=bool(rollout.plan))
        progress = [_progress(each, states) for each in robots]
        batch = max(_MIN_BATCH, len(robots) // _BATCHES)
        steps = next_steps(_rollout_progress(rollout, policy, robots), progress, now, batch)
        return _Step(rollout=rollout, policy=policy, robots=robots, states=states, next=steps)


def _store_step(session: Session, step: _Step, now: int) -> str:
    """Store what a roll-out comes to; return the alert that it goes back, "" if it does not."""
    rollout, next = step.rollout, step.next
    rollout.stage = next.stage
    before = RolloutState(rollout.state)
    if next.state == before:
        return ""
    set_state(rollout, next.state, rollout.note if next.note is None else next.note, now)
    detail = {"state": next.state, "note": rollout.note}
    event = AuditEvent(
        who=_ACTOR, action="rollout.state", target=f"rollout/{rollout.id}", detail=detail
    )
    record_event(session, now, event)
    return going_back_alert(rollout.id, before, next.state, rollout.note)


def _rollout_progress(
    rollout: RolloutRow, policy: RolloutPolicy, robots: Sequence[RobotOfRollout]
) -> RolloutProgress:
    wait = round(policy.wait * SECOND)
    return RolloutProgress(
        state=RolloutState(rollout.state),
        stage=rollout.stage,
        changed=rollout.changed,
        targets=stage_targets(policy.stages, len(robots)),
        wait=wait,
        pace=min(wait, PACE),
        limits=policy.limits,
    )


def _progress(robot: RobotOfRollout, states: Mapping[str, GuardState]) -> RobotProgress:
    return RobotProgress(
        robot=robot.name,
        phase=RobotPhase(robot.row.phase),
        is_ready=robot.name in states,
        is_answered=robot.outcome not in {None, SettingsOutcome.PENDING},
        sent_at=robot.row.sent_at or 0,
        problems=frozenset(map(Problem, robot.row.problems)),
    )
