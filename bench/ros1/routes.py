"""The ways from a publisher to a subscriber: direct, through peers, through the guard."""

import signal
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER, Route
from bench.common.testbed import Testbed, python, run_guard, running
from rtron.vocabulary import GRCN, Plan, flow_topic, output_topic

_TOOLS = "/usr/lib/topic_tools"


def direct(number: int = 1) -> Route:
    """Return the way of many topics with nothing in between."""
    topics = [f"/bench_{index}" for index in range(number)]
    return Route("direct", list(map(_from, topics)), topics)


def relays(number: int = 1) -> Route:
    """Return relays that each have their own topic."""
    pairs = [(f"/bench_{index}", f"/bench_{index}_out") for index in range(number)]
    inputs, outputs = zip(*pairs, strict=True)
    return Route("relay", list(map(_from, inputs)), outputs, lambda s: _relays(s, pairs))


def staged(number: int) -> Route:
    """Return the way through many coordination nodes on one stream, more than a plan can have."""
    inputs = [_from(flow_topic("/cmd_vel", "flow1"))]
    command = python("bench.ros1.guard_process", "--stages", str(number))
    name = f"{number} nodes"
    return Route(name, inputs, [output_topic("/cmd_vel")], lambda s: running(s, command))


def guard(*grcns: GRCN) -> Route:
    """Return the way through the guard, by every flow of these coordination nodes."""
    return guard_of(Plan(app="bench", grcn=grcns or (grcn("/cmd_vel", [PUBLISHER]),)))


def guard_of(plan: Plan) -> Route:
    """Return the way through the guard of a plan, by every flow of its coordination nodes."""
    inputs = [
        f"{flow.publisher}={flow_topic(node.topic, flow.name)}"
        for node in plan.grcn
        for flow in node.flows
    ]
    outputs = [output_topic(node.topic) for node in plan.grcn]
    return Route("guard", inputs, outputs, lambda s: run_guard(s, plan))


@contextmanager
def _relays(testbed: Testbed, pairs: Sequence[tuple[str, str]]) -> Iterator[Any]:
    with ExitStack() as stack:
        started = [
            stack.enter_context(running(testbed, _relay(*pair, index), signal.SIGINT))
            for index, pair in enumerate(pairs)
        ]
        yield started[0]


def _relay(source: str, target: str, index: int) -> list[str]:
    return [f"{_TOOLS}/relay", source, target, f"__name:=bench_relay_{index}"]


def _from(topic: str) -> str:
    return f"{PUBLISHER}={topic}"
