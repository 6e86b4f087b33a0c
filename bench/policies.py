"""What a verdict costs, by policy: 20 flows that speak in turn, ticked as the guard does."""

import time
from collections.abc import Iterator
from statistics import median

from bench.part import Say
from bench.plans import flows
from bench.site import Site
from figures.figure import Figure
from rtron.policies import POLICIES, Policy, build
from rtron.vocabulary import PolicyName, PolicySettings, StreamKind

_FLOWS = 20
_ROUNDS = 1000
_REPEATS = 15
_PERIOD = 200_000
"""Between two messages, ns: 5,000 a second."""
_AT_MOST_US = 20.0


def figures(_here: Site, say: Say) -> Iterator[Figure]:
    """Give the median cost of a verdict, us."""
    for name in POLICIES:
        say(str(name))
        cost = median(cost_of(name) for _ in range(_REPEATS))
        yield Figure(f"policies.{name}", cost, None, "us a verdict", at_most=_AT_MOST_US)


def cost_of(name: PolicyName) -> float:
    """Return what a verdict costs, with the tick if one is due, us."""
    names = [f"/n{index}" for index in range(_FLOWS)]
    policy = build(PolicySettings(policy=name, kind=StreamKind.COMMAND, flows=flows(names)))
    speakers = [f"flow{index + 1}" for index in range(_FLOWS)] * _ROUNDS
    start = time.perf_counter_ns()
    _decide(policy, speakers)
    return (time.perf_counter_ns() - start) / len(speakers) / 1000


def _decide(policy: Policy, speakers: list[str]) -> None:
    for now, flow in enumerate(speakers):
        at = now * _PERIOD
        policy.verdict(flow, b"", at)
        due = policy.deadline()
        if due is not None and due <= at:
            policy.tick(at)
