"""What a roll-out does next: which robots get the change, which lose it. No I/O, no clock."""

from collections import defaultdict
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from random import Random

from rtron.service.domain.rollouts.amounts import Amount
from rtron.service.domain.rollouts.schemas import Problem, RobotPhase, RolloutState

_MAX_NAMED = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotProgress:
    """A robot of a roll-out, in the order of getting the change.

    `is_ready`: its guard is connected and has told its state. `is_answered`: the guard has answered
    the change, or a newer one. `sent_at` is wall clock, ns.
    """

    robot: str
    phase: RobotPhase = RobotPhase.WAITING
    is_ready: bool = True
    is_answered: bool = False
    sent_at: int = 0
    problems: frozenset[Problem] = frozenset()

    @property
    def has_change(self) -> bool:
        """Whether it has the change, or may have it."""
        return self.phase in {RobotPhase.SENDING, RobotPhase.SENT}

    @property
    def is_settled(self) -> bool:
        """Whether it is known what became of the change: an alarm alone does not tell."""
        has_failed = bool(self.problems & {Problem.REFUSED, Problem.GONE})
        return not self.has_change or self.is_answered or has_failed


@dataclass(frozen=True, slots=True, kw_only=True)
class RolloutProgress:
    """A roll-out; `targets` is how many robots have the change after each stage.

    `changed` is when it came to its state, `wait` the time between two stages, and `pace` how long
    a robot that just got the change holds up the next ones of its stage, ns.
    """

    state: RolloutState
    stage: int
    changed: int
    targets: Sequence[int]
    wait: int
    limits: Mapping[Problem, Amount]
    pace: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class NextSteps:
    """What to do: robots that get the change, and that lose it; what the roll-out is at then."""

    state: RolloutState
    stage: int
    send: Sequence[str] = ()
    revert: Sequence[str] = ()
    note: str | None = None


def stage_targets(stages: Sequence[Amount], total: int) -> tuple[int, ...]:
    """Return how many of `total` robots have the change after each stage, always more."""
    targets: list[int] = []
    for stage in stages:
        target = min(stage.at_least(total), total)
        if not targets or target > targets[-1]:
            targets.append(target)
    return tuple(targets)


def spread_kinds(kinds: Mapping[str, Hashable], seed: int) -> Sequence[str]:
    """Return the robots, each prefix with every kind by its share, and first one of each kind.

    A change that is bad for one kind of robot alone so shows that in a small stage. Within a kind,
    and among kinds of one size, the order is random.
    """
    random = Random(seed)  # noqa: S311 - it is no secret
    groups: defaultdict[Hashable, list[str]] = defaultdict(list)
    for robot in sorted(kinds):
        groups[kinds[robot]].append(robot)
    places: list[tuple[float, int, float, str]] = []
    for group in groups.values():
        random.shuffle(group)
        rank = random.random()
        places += [
            (index / len(group), -len(group), rank, robot) for index, robot in enumerate(group)
        ]
    return [robot for *_, robot in sorted(places)]


def next_steps(
    rollout: RolloutProgress, robots: Sequence[RobotProgress], now: int, batch: int
) -> NextSteps:
    """Return what to do at `now` (ns), with at most `batch` robots at a time.

    Within a stage at most so many get the change within `pace`: what is bad shows meanwhile.
    """
    if rollout.state is RolloutState.REVERTING:
        return _revert(rollout, robots, batch)
    if rollout.state is RolloutState.DONE:
        return _catch_up(rollout, robots, batch)
    if rollout.state not in {RolloutState.RUNNING, RolloutState.PAUSED}:
        return NextSteps(state=rollout.state, stage=rollout.stage)
    if broken := "; ".join(broken_limits(rollout.limits, robots)):
        return _revert(rollout, robots, batch, broken)
    if rollout.state is RolloutState.PAUSED:
        return NextSteps(state=rollout.state, stage=rollout.stage)
    return _advance(rollout, robots, now, batch)


def broken_limits(
    limits: Mapping[Problem, Amount], robots: Sequence[RobotProgress]
) -> Iterator[str]:
    """Yield which limits are passed, and by which robots."""
    reached = [each for each in robots if each.has_change]
    for problem, limit in limits.items():
        names = [each.robot for each in reached if problem in each.problems]
        allowed = limit.at_most(len(reached))
        if len(names) > allowed:
            more = f" and {len(names) - _MAX_NAMED} more" if len(names) > _MAX_NAMED else ""
            yield (
                f"{problem}: {len(names)} of {len(reached)} robots, at most {allowed}: "
                f"{', '.join(names[:_MAX_NAMED])}{more}"
            )


def _advance(
    rollout: RolloutProgress, robots: Sequence[RobotProgress], now: int, batch: int
) -> NextSteps:
    begun = [each.robot for each in robots if each.phase is RobotPhase.SENDING]
    reached = sum(each.phase is not RobotPhase.WAITING for each in robots)
    free = rollout.targets[rollout.stage] - reached
    new = sum(each.has_change and now - each.sent_at < rollout.pace for each in robots)
    ready = _ready(robots)[: max(0, min(free, batch - new))]
    if begun or ready:
        send = [*begun, *ready][:batch]
        return NextSteps(state=rollout.state, stage=rollout.stage, send=send)
    is_last = rollout.stage == len(rollout.targets) - 1
    if (free > 0 and not is_last) or not _is_watched_enough(rollout, robots, now):
        return NextSteps(state=rollout.state, stage=rollout.stage)
    if is_last:
        off = f"{free} robots were off" if free > 0 else ""
        return NextSteps(state=RolloutState.DONE, stage=rollout.stage, note=off)
    return NextSteps(state=rollout.state, stage=rollout.stage + 1)


def _is_watched_enough(rollout: RolloutProgress, robots: Sequence[RobotProgress], now: int) -> bool:
    """Tell whether all have settled, and the last one got the change a `wait` ago."""
    last = max((each.sent_at for each in robots if each.has_change), default=None)
    is_settled = all(each.is_settled for each in robots)
    return last is not None and is_settled and now - last >= rollout.wait


def _revert(
    rollout: RolloutProgress, robots: Sequence[RobotProgress], batch: int, note: str | None = None
) -> NextSteps:
    revert = [each.robot for each in robots if each.has_change][:batch]
    state = RolloutState.REVERTING if revert else RolloutState.REVERTED
    return NextSteps(state=state, stage=rollout.stage, revert=revert, note=note)


def _catch_up(rollout: RolloutProgress, robots: Sequence[RobotProgress], batch: int) -> NextSteps:
    """Reach the robots that were off; one that shows a problem then loses the change by itself."""
    begun = [each.robot for each in robots if each.phase is RobotPhase.SENDING]
    late = [each for each in robots if each.has_change and each.sent_at > rollout.changed]
    revert = [each.robot for each in late if each.problems][:batch]
    send = [name for name in (*begun, *_ready(robots)) if name not in revert][:batch]
    return NextSteps(state=rollout.state, stage=rollout.stage, send=send, revert=revert)


def _ready(robots: Sequence[RobotProgress]) -> list[str]:
    waiting = (each for each in robots if each.phase is RobotPhase.WAITING)
    return [each.robot for each in waiting if each.is_ready]
