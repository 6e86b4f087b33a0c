"""Read the running app: `python -m bench.ros2.graph_reader ours|plain` prints a line of JSON.

`ours` is RTron's source, `plain` a node that spins for a second and asks rclpy, as `ros2 node list`
and `ros2 node info` do. The result is `seconds` of the read, and the entries `missing` and `wrong`.
"""

import json
import sys
import time
from contextlib import suppress
from typing import Any

import rclpy

from bench.ros2.app import ExpectedApp, expected_app
from rtron.sources.live.ros2.source import Ros2LiveSource

_PLAIN_S = 1.0
_TIMEOUT_S = 30.0
_IMPLIED = ("/rosout", "/parameter_events")


def main() -> None:
    """Read the app once."""
    start = time.monotonic()
    found = _ours() if sys.argv[1] == "ours" else _plain()
    seconds, expected = time.monotonic() - start, expected_app()
    result = {
        "seconds": seconds,
        "missing": expected.missing(found),
        "wrong": expected.wrong(found),
    }
    print(json.dumps(result), flush=True)


def _ours() -> ExpectedApp:
    graph = Ros2LiveSource(None, _TIMEOUT_S).read()
    return ExpectedApp(
        frozenset(node.name for node in graph.nodes),
        frozenset(
            (e.node, e.topic, e.direction.value, e.type) for e in graph.endpoints if not e.implicit
        ),
        frozenset((each.node, each.name) for each in graph.services if not each.implicit),
    )


def _plain() -> ExpectedApp:
    rclpy.init()
    node = rclpy.create_node("_bench_plain")
    end = time.monotonic() + _PLAIN_S
    while (left := end - time.monotonic()) > 0:
        rclpy.spin_once(node, timeout_sec=left)
    nodes = set(node.get_node_names_and_namespaces()) - {("_bench_plain", "/")}
    found = [_info(node, base, space) for base, space in nodes]
    rclpy.shutdown()
    return ExpectedApp(
        frozenset(f"{space.rstrip('/')}/{base}" for base, space in nodes),
        frozenset(end for each in found for end in each.endpoints),
        frozenset(service for each in found for service in each.services),
    )


def _info(node: Any, base: str, space: str) -> ExpectedApp:  # noqa: ANN401 - rclpy has no types
    """Return what rclpy tells of a node; nothing if it is none any more."""
    name = f"{space.rstrip('/')}/{base}"
    with suppress(RuntimeError):
        sides = {
            "publish": node.get_publisher_names_and_types_by_node(base, space),
            "subscribe": node.get_subscriber_names_and_types_by_node(base, space),
        }
        services = node.get_service_names_and_types_by_node(base, space)
        endpoints = (
            (name, topic, direction, type)
            for direction, topics in sides.items()
            for topic, types in topics
            for type in types
            if topic not in _IMPLIED
        )
        service_names = (service for service, types in services if types[0].startswith("std_srvs/"))
        return ExpectedApp(
            frozenset(), frozenset(endpoints), frozenset((name, each) for each in service_names)
        )
    return ExpectedApp(frozenset(), frozenset(), frozenset())


if __name__ == "__main__":
    main()
