"""An app of real ROS 2 nodes, made by rule: `python -m bench.ros2.app FIRST COUNT`.

The process is one participant with COUNT nodes from number FIRST on; it says `ready` and stays
until its standard input ends. What the whole app is, `expected_app` tells.
"""

import sys
from dataclasses import dataclass
from importlib import import_module
from typing import Any

NODES = 60
TOPICS = 300
_TYPES = (
    "std_msgs/msg/String",
    "geometry_msgs/msg/Twist",
    "sensor_msgs/msg/LaserScan",
    "nav_msgs/msg/Odometry",
    "std_msgs/msg/Bool",
)
_SERVICE = "std_srvs/srv/Trigger"
_SERVING = 4
"""Every so manieth node serves something."""


@dataclass(frozen=True, slots=True)
class ExpectedApp:
    """What the app has: endpoints as (node, topic, direction, type), services as (node, name)."""

    nodes: frozenset[str]
    endpoints: frozenset[tuple[str, str, str, str]]
    services: frozenset[tuple[str, str]]

    def missing(self, found: "ExpectedApp") -> int:
        """Return how many of its entries are not among those found."""
        return sum(len(ours - theirs) for ours, theirs in self._beside(found))

    def wrong(self, found: "ExpectedApp") -> int:
        """Return how many of the entries found are not the app's."""
        return sum(len(theirs - ours) for ours, theirs in self._beside(found))

    def _beside(self, found: "ExpectedApp") -> tuple[tuple[frozenset[Any], frozenset[Any]], ...]:
        return (
            (self.nodes, found.nodes),
            (self.endpoints, found.endpoints),
            (self.services, found.services),
        )


def expected_app() -> ExpectedApp:
    """Return the app that all processes make together."""
    return ExpectedApp(
        frozenset(map(node_name, range(NODES))),
        frozenset(end for topic in range(TOPICS) for end in _topic_endpoints(topic)),
        frozenset((node_name(n), service_name(n)) for n in range(0, NODES, _SERVING)),
    )


def node_name(number: int) -> str:
    """Return the full name of a node."""
    return f"/robot{number % 6}/node{number}"


def service_name(number: int) -> str:
    """Return the name of a node's service."""
    return f"{node_name(number)}/start"


def _topic_endpoints(topic: int) -> list[tuple[str, str, str, str]]:
    """Return the publisher and the two subscribers of a topic."""
    name, type = f"/area{topic % 20}/topic{topic}", _TYPES[topic % len(_TYPES)]
    first, second = (topic * 7 + 1) % NODES, (topic * 11 + 6) % NODES
    return [
        (node_name(topic % NODES), name, "publish", type),
        (node_name(first), name, "subscribe", type),
        (node_name(second), name, "subscribe", type),
    ]


def main() -> None:
    """Be some of the nodes until the standard input ends."""
    from rclpy.context import Context  # noqa: PLC0415 - the app is told without a ROS 2, too

    first, count = map(int, sys.argv[1:])
    context = Context()
    context.init(args=[])
    nodes = [_node(number, context) for number in range(first, first + count)]
    print("ready", flush=True)
    sys.stdin.read()
    for node in nodes:
        node.destroy_node()
    context.try_shutdown()


def _node(number: int, context: Any) -> Any:  # noqa: ANN401 - rclpy has no types
    from rclpy.node import Node  # noqa: PLC0415

    space, _, base = node_name(number).rpartition("/")
    node = Node(base, namespace=space, context=context)
    for owner, topic, direction, type in expected_app().endpoints:
        if owner == node_name(number):
            _open(node, topic, direction, _class(type))
    if number % _SERVING == 0:
        node.create_service(_class(_SERVICE), service_name(number), lambda _, answer: answer)
    return node


def _open(node: Any, topic: str, direction: str, type: Any) -> None:  # noqa: ANN401
    if direction == "publish":
        node.create_publisher(type, topic, 10)
    else:
        node.create_subscription(type, topic, lambda _: None, 10)


def _class(type: str) -> Any:  # noqa: ANN401
    package, kind, name = type.split("/")
    return getattr(import_module(f"{package}.{kind}"), name)


if __name__ == "__main__":
    main()
