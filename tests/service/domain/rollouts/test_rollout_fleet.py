"""1,000 robots and a change that is bad on 3 % of them: how many it reaches before it goes back."""

from dataclasses import replace
from random import Random

import pytest

from rtron.service.domain.rollouts.amounts import Amount
from rtron.service.domain.rollouts.decisions import (
    RobotProgress,
    RolloutProgress,
    next_steps,
    spread_kinds,
    stage_targets,
)
from rtron.service.domain.rollouts.schemas import DEFAULT_STAGES, Problem, RobotPhase, RolloutState

ROBOTS = [f"r{index:04}" for index in range(1000)]
BAD, BATCH, WAIT, PACE, SHOWS_AFTER = 30, 20, 60, 10, 3
LIMITS = {problem: Amount(0) for problem in Problem}


def roll_out(order, bad):
    """Return how many of the robots had the change before it went back, and how it ended."""
    robots = {robot: RobotProgress(robot=robot) for robot in order}
    state, stage, reached = RolloutState.RUNNING, 0, set()
    targets = stage_targets(DEFAULT_STAGES, len(order))
    for now in range(1000):
        for robot in reached & bad:
            if now - robots[robot].sent_at >= SHOWS_AFTER:
                robots[robot] = replace(robots[robot], problems=frozenset({Problem.ALARM}))
        rollout = RolloutProgress(
            state=state,
            stage=stage,
            changed=0,
            targets=targets,
            wait=WAIT,
            pace=PACE,
            limits=LIMITS,
        )
        steps = next_steps(rollout, list(robots.values()), now, BATCH)
        state, stage = steps.state, steps.stage
        for robot in steps.send:
            has = {"phase": RobotPhase.SENT, "is_answered": True, "sent_at": now}
            robots[robot] = replace(robots[robot], **has)
            reached.add(robot)
        for robot in steps.revert:
            robots[robot] = replace(robots[robot], phase=RobotPhase.REVERTED)
        if state in {RolloutState.REVERTED, RolloutState.DONE}:
            break
    left = sum(each.has_change for each in robots.values())
    return len(reached), state, left


@pytest.mark.parametrize("seed", range(10))
def test_what_is_bad_for_a_kind_never_passes_the_stage_after_the_canary(seed):
    bad = set(Random(seed).sample(ROBOTS, BAD))
    order = spread_kinds({robot: robot in bad for robot in ROBOTS}, seed)
    reached, state, left = roll_out(order, bad)
    assert reached <= 21
    assert (state, left) == (RolloutState.REVERTED, 0)


def test_what_nothing_distinguishes_reaches_hardly_more_than_the_first_bad_one():
    random, reached = Random(1), []
    for seed in range(20):
        bad = set(random.sample(ROBOTS, BAD))
        count, state, left = roll_out(spread_kinds(dict.fromkeys(ROBOTS), seed), bad)
        assert (state, left) == (RolloutState.REVERTED, 0)
        reached.append(count)
    assert sum(count <= 100 for count in reached) >= 17
    assert max(reached) <= 140


def test_a_good_change_reaches_all():
    assert roll_out(ROBOTS, set()) == (1000, RolloutState.DONE, 1000)
