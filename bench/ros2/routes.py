"""The ways from a publisher to a subscriber on ROS 2."""

import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER, Route
from bench.common.testbed import Testbed, python, run_guard, running
from bench.ros2.c_relay import relay_library
from bench.ros2.messages import MESSAGES
from rtron.vocabulary import Plan, flow_topic, output_topic

_FROM, _TO = "/bench_0", "/bench_1"


def direct() -> Route:
    """Return the way with nothing in between."""
    return Route("direct", [f"{PUBLISHER}=/bench"], ["/bench"], ros=2)


def relay(message: str = "twist") -> Route:
    """Return the way through a relay of rclpy."""
    command = python("bench.ros2.relay", message, f"{_FROM}={_TO}")
    opened = partial(running, command=command, stop=signal.SIGINT)
    return Route("relay", [f"{PUBLISHER}={_FROM}"], [_TO], opened, ros=2)


def c_relay(message: str = "twist") -> Route:
    """Return the way through a relay in C."""
    opened = partial(_run_c_relay, message=message)
    return Route("c_relay", [f"{PUBLISHER}={_FROM}"], [_TO], opened, ros=2)


def parallel_relays(number: int) -> Route:
    """Return one relay of rclpy of many topics."""
    topics = [f"/bench_{index}" for index in range(number)]
    pairs = [f"{topic}={topic}/out" for topic in topics]
    command = python("bench.ros2.relay", "twist", *pairs)
    outputs = [f"{topic}/out" for topic in topics]
    inputs = [f"{PUBLISHER}={topic}" for topic in topics]
    opened = partial(running, command=command, stop=signal.SIGINT)
    return Route("relay", inputs, outputs, opened, ros=2)


def guard(message: str = "twist", number: int = 1) -> Route:
    """Return the way through the guard: `number` topics, a coordination node each."""
    topics = [f"/bench_{index}" for index in range(number)]
    nodes = tuple(grcn(topic, [PUBLISHER], MESSAGES[message].type) for topic in topics)
    opened = partial(run_guard, plan=Plan(app="bench", ros=2, grcn=nodes))
    return Route("guard", *_guarded(topics), opened, ros=2)


def staged(stages: int) -> Route:
    """Return the way through many coordination nodes on one stream, more than a plan can have."""
    command = python("bench.ros2.guard_process", str(stages))
    opened = partial(running, command=command)
    return Route(f"{stages} nodes", *_guarded(["/bench_0"]), opened, ros=2)


def _guarded(topics: list[str]) -> tuple[list[str], list[str]]:
    """Return where publishers and subscribers of guarded topics are moved to."""
    inputs = [f"{PUBLISHER}={flow_topic(topic, 'flow1')}" for topic in topics]
    return inputs, [output_topic(topic) for topic in topics]


@contextmanager
def _run_c_relay(testbed: Testbed, message: str) -> Iterator[subprocess.Popen[str]]:
    library = relay_library(testbed)
    command = python("bench.ros2.c_relay", str(library), message, _FROM, _TO)
    with running(testbed, command) as process:
        yield process
