"""A relay as one writes it with rclpy: `python -m bench.ros2.relay MESSAGE FROM=TO ...`.

Raw messages, SingleThreadedExecutor.
"""

import sys
from functools import partial

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from bench.ros2.endpoints import class_of, node, qos
from bench.ros2.messages import MESSAGES


def main() -> None:
    """Relay until told to end."""
    message, *pairs = sys.argv[1:]
    kind = class_of(MESSAGES[message].type)
    relay_node = node(f"/bench_relay{pairs[0].replace('/', '_').replace('=', '_')}")
    for pair in pairs:
        source, target = pair.split("=")
        publisher = relay_node.create_publisher(kind, target, qos())
        relay_node.create_subscription(kind, source, partial(_pass, publisher), qos(), raw=True)
    executor = SingleThreadedExecutor(context=relay_node.context)
    executor.add_node(relay_node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


def _pass(publisher, message: bytes) -> None:  # noqa: ANN001 - rclpy has no types
    publisher.publish(message)


if __name__ == "__main__":
    main()
