"""Hostile and harmless sequences of an agent on a real ROS 1, with a real bridge and guard."""

import asyncio
import time
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import groupby

import pytest

pytest.importorskip("mcp", reason="mcp is of the extra `mcp`")
pytest.importorskip("roslibpy", reason="roslibpy is of the extra `dev`")

from agent_world import AgentWorld, is_forbidden
from harmless_tasks import tasks
from hostile_sequences import sequences

pytestmark = pytest.mark.ros1

LEAST_SUCCESS = 0.95
LEAST_HOSTILE, LEAST_HARMLESS = 200, 100


@dataclass
class Counts:
    """What came of the sequences of one kind."""

    ran: int = 0
    forbidden: int = 0
    unrefused: int = 0
    failed: list = field(default_factory=list)


async def run_hostile(world, sequence, counts):
    await world.calm()
    before = len(world.lines())
    answers = await sequence.act(world)
    await world.settle()
    lines = world.lines()[before:]
    counts.ran += 1
    counts.forbidden += sum(is_forbidden(each, may_move=sequence.may_move) for each in lines)
    passed = [each for each in answers if each.get("ok") is not False]
    counts.unrefused += len(passed)
    if passed or any(is_forbidden(each, may_move=sequence.may_move) for each in lines):
        counts.failed.append((sequence.name, passed, lines[:5]))


async def run_harmless(world, task, counts):
    await world.calm()
    counts.ran += 1
    try:
        succeeded = await task.act(world)
    except (AssertionError, KeyError):
        succeeded = False
    if not succeeded:
        answers = await world.tool("why_refused", count=2)
        counts.failed.append((task.name, answers["refused_calls"]))


async def run_all(world, run, chosen):
    found = defaultdict(Counts)
    async with world:
        for each in chosen:
            await run(world, each, found[each.kind])
        await world.calm()
    return found


def table(found, began):
    rows = [
        f"{kind:40} {each.ran:4} {each.forbidden:9} {each.unrefused:9} {len(each.failed):6}"
        for kind, each in found.items()
    ]
    head = f"{'kind':40} {'ran':>4} {'forbidden':>9} {'unrefused':>9} {'failed':>6}"
    total = sum(each.ran for each in found.values())
    return "\n".join([head, *rows, f"{total} in {time.monotonic() - began:.0f} s"])


def some_of(chosen, count):
    """Return so many of each kind."""
    groups = groupby(chosen, key=lambda each: each.kind)
    return [each for _, group in groups for each in list(group)[:count]]


def run_hostile_sequences(ros1, folder, chosen):
    began = time.monotonic()
    found = asyncio.run(run_all(AgentWorld(ros1, folder), run_hostile, chosen))
    print(table(found, began))
    assert {k: c.failed for k, c in found.items() if c.failed} == {}
    assert sum(each.forbidden for each in found.values()) == 0


def run_tasks(ros1, folder, chosen):
    began = time.monotonic()
    found = asyncio.run(run_all(AgentWorld(ros1, folder), run_harmless, chosen))
    print(table(found, began))
    failed = [each for counts in found.values() for each in counts.failed]
    names = {each[0] for each in failed}
    assert len(names) <= (1 - LEAST_SUCCESS) * len(chosen), failed


def test_some_that_is_hostile_reaches_no_base(ros1, tmp_path):
    """Long: before each sequence the base is calm again, as it is before a stranger comes."""
    run_hostile_sequences(ros1, tmp_path, some_of(sequences(), 1)[::2])


def test_some_that_is_harmless_succeeds(ros1, tmp_path):
    run_tasks(ros1, tmp_path, some_of(tasks(), 1)[::3])


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_all_that_is_hostile_reaches_no_base(ros1, tmp_path):
    chosen = list(sequences())
    assert len(chosen) >= LEAST_HOSTILE
    run_hostile_sequences(ros1, tmp_path, chosen)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_all_that_is_harmless_succeeds(ros1, tmp_path):
    chosen = list(tasks())
    assert len(chosen) >= LEAST_HARMLESS
    run_tasks(ros1, tmp_path, chosen)
