"""The ways from a publisher to a subscriber on ROS 2."""

import signal
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from itertools import pairwise
from typing import Any

from bench.common.pubsub import PUBLISHER, Route
from bench.common.testbed import Testbed, python, running
from rtron.vocabulary import flow_topic, output_topic


def direct() -> Route:
    """Return the way with nothing in between."""
    return Route("direct", [f"{PUBLISHER}=/bench"], ["/bench"], ros=2)


def relay(length: int = 1, message: str = "twist") -> Route:
    """Return a chain of relays, a process each."""
    topics = [f"/bench_{index}" for index in range(length + 1)]
    name = "relay" if length == 1 else f"{length} relays"
    pairs = [f"{source}={target}" for source, target in pairwise(topics)]
    opened = partial(_relays, message=message, pairs=pairs)
    return Route(name, [f"{PUBLISHER}={topics[0]}"], [topics[-1]], opened, ros=2)


def parallel_relays(number: int) -> Route:
    """Return one relay of many topics."""
    topics = [f"/bench_{index}" for index in range(number)]
    pairs = [f"{topic}={topic}/out" for topic in topics]
    command = python("bench.ros2.relay", "twist", *pairs)
    outputs = [f"{topic}/out" for topic in topics]
    inputs = [f"{PUBLISHER}={topic}" for topic in topics]
    opened = partial(running, command=command, stop=signal.SIGINT)
    return Route("relay", inputs, outputs, opened, ros=2)


def guard(stages: int = 1, type: str = "geometry_msgs/msg/Twist", number: int = 1) -> Route:
    """Return the way through the guard: `number` topics, through `stages` coordination nodes."""
    topics = [f"/bench_{index}" for index in range(number)]
    command = python("bench.ros2.guard_process", str(stages), type, str(number))
    return Route(
        "guard" if stages == 1 else f"{stages} nodes",
        [f"{PUBLISHER}={flow_topic(topic, 'flow1')}" for topic in topics],
        [output_topic(topic) for topic in topics],
        partial(running, command=command),
        ros=2,
    )


@contextmanager
def _relays(testbed: Testbed, message: str, pairs: list[str]) -> Iterator[Any]:
    with ExitStack() as stack:
        started = [
            stack.enter_context(
                running(testbed, python("bench.ros2.relay", message, pair), signal.SIGINT)
            )
            for pair in pairs
        ]
        yield started[0]
