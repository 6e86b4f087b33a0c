"""How many velocities above the limit get through: the bytes that go in beside those that go out.

Generated messages of every velocity type go through Constrain as the guard has it, decoded and
encoded again, under limits of all sizes. Wanted are none above the limit, none with NaN or Inf,
and no curvature that differs by more than 1e-9 (per metre, or of itself where it is above 1).
"""

import random
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context

from bench.common.plans import flows
from bench.common.testbed import ReportProgress, Testbed
from bench.common.velocities import KINDS, Kind, VelocityCheck, messages, random_limit
from bench.common.workload import VIOLATIONS
from figures.figure import Figure
from rtron.guard.core.velocity_adapter import VelocityAdapter
from rtron.messages import DefinitionRegistry, Encoding, VelocityCodec, velocity_codec
from rtron.policies import FrameMonitors
from rtron.policies.velocity_limit.constrain import Constrain
from rtron.vocabulary import Decision, PolicyName, PolicySettings, StreamKind

_FAULTS = ("above", "curvature", "not_finite")
_PROCESSES = 2
_TASK = 100_000
_BATCH = 1000
"""Messages under one limit."""
Task = tuple[Kind, int, int]
"""The type, how many messages, and the seed that they come from."""


def figures(_testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the faults, and what became of the messages."""
    found: Counter[str] = Counter()
    for counts in _run(list(_tasks())):
        found += counts
        progress(f"{found['ran']:,} of {VIOLATIONS:,} messages")
    unit = f"of {found['ran']:,} messages"
    for fault in _FAULTS:
        yield Figure(f"violations.{fault}", found[fault], None, unit, at_most=0)
    for decision in (Decision.PASS, Decision.MODIFY, Decision.DROP):
        yield Figure(f"violations.{decision}", found[decision], None, unit)


def _tasks() -> Iterator[Task]:
    for kind, part in KINDS.items():
        count = round(part * VIOLATIONS)
        for first in range(0, count, _TASK):
            yield kind, min(_TASK, count - first), first


def _run(tasks: list[Task]) -> Iterator[Counter[str]]:
    with ProcessPoolExecutor(_PROCESSES, get_context("spawn")) as pool:
        for done in as_completed([pool.submit(count, *task) for task in tasks]):
            yield done.result()


def count(kind: Kind, number: int, seed: int) -> Counter[str]:
    """Return how many of so many messages ran, what became of them and what was wrong."""
    draw = random.Random(f"{kind.type} {seed}")
    definition = DefinitionRegistry().find(kind.type)
    codec = velocity_codec(definition, Encoding.ROS1) if definition else None
    if codec is None:
        raise AssertionError(f"{kind.type} holds a velocity")
    counts: Counter[str] = Counter(ran=number)
    for first in range(0, number, _BATCH):
        counts += _batch(kind, codec, min(_BATCH, number - first), draw)
    return counts


def _batch(kind: Kind, codec: VelocityCodec, number: int, draw: random.Random) -> Counter[str]:
    limit = random_limit(draw)
    policy, check, counts = _policy(codec, limit), VelocityCheck(kind, limit), Counter[str]()
    for original in messages(kind, limit, number, draw):
        verdict = policy.verdict("flow1", original, 0)
        counts[verdict.decision] += 1
        limited = original if verdict.decision is Decision.PASS else verdict.message
        if verdict.decision is not Decision.DROP:
            counts.update(check.violations(original, limited))  # type: ignore[arg-type]
    return counts


def _policy(codec: VelocityCodec, limit: float) -> VelocityAdapter:
    settings = PolicySettings(
        policy=PolicyName.CONSTRAIN,
        kind=StreamKind.COMMAND,
        flows=flows(["/n"]),
        max_vel_limit=limit,
    )
    decoding = VelocityAdapter(Constrain(settings, FrameMonitors()))
    decoding.learn(codec)
    return decoding
