"""What a verdict costs, by policy: 20 flows that speak in turn, ticked as the guard does.

Policies that limit a velocity are given one above the limit by flows without an order, so that
each is changed; the camera that Safe depends on has 30 frames a second.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from statistics import median

from bench.common.plans import flows
from bench.common.testbed import ReportProgress, Testbed
from figures.figure import Figure
from rtron.policies import POLICIES, FrameMonitors, Policy, build_policy
from rtron.vocabulary import SECOND, FpsMonitor, PolicyName, PolicySettings, StreamKind, Velocity

_FLOWS = 20
_ROUNDS = 1000
_REPEATS = 15
_PERIOD = 200_000
"""Between two messages, ns: 5,000 a second."""
_FRAME = SECOND // 30 // _PERIOD
"""Messages from one frame of the camera to the next."""
_AT_MOST_US = 20.0
_LIMITS = {PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN}
_CAMERA = FpsMonitor(id="camera", node="/detector", topic="/detector/image")
_FAST = Velocity((2.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def figures(_testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the median cost of a verdict, us."""
    for name in POLICIES:
        progress(str(name))
        cost = median(cost_of(name) for _ in range(_REPEATS))
        yield Figure(f"policies.{name}", cost, None, "us a verdict", at_most=_AT_MOST_US)


def cost_of(name: PolicyName) -> float:
    """Return what a verdict costs, with the tick if one is due, us."""
    rates = FrameMonitors([_CAMERA])
    policy = build_policy(_settings(name), rates)
    message = _FAST if name in _LIMITS else b""
    speakers = [f"flow{index + 1}" for index in range(_FLOWS)] * _ROUNDS
    start = time.perf_counter_ns()
    for first in range(0, len(speakers), _FRAME):
        rates.monitors[_CAMERA.id].add_frame(0, first * _PERIOD)
        _decide(policy, message, speakers[first : first + _FRAME], first)
    return (time.perf_counter_ns() - start) / len(speakers) / 1000


def _settings(name: PolicyName) -> PolicySettings:
    flow_list = flows([f"/n{index}" for index in range(_FLOWS)])
    if name in _LIMITS:
        flow_list = tuple(replace(flow, priority=0) for flow in flow_list)
    return PolicySettings(
        policy=name, kind=StreamKind.COMMAND, flows=flow_list, threshold=0.02, max_vel_limit=0.5
    )


def _decide(policy: Policy, message: object, speakers: Sequence[str], first: int) -> None:
    for now, flow in enumerate(speakers, start=first):
        at = now * _PERIOD
        policy.verdict(flow, message, at)
        due = policy.deadline()
        if due is not None and due <= at:
            policy.tick(at)
