"""The process that sends on ROS 2: `python -m bench.ros2.generator --publish NODE=TOPIC ...`.

As `bench.ros1.generator`, with rclpy's own publishers.
"""

import json
import select
import signal
import sys
import time
from itertools import cycle
from typing import Any

from bench.common.arguments import to_send
from bench.common.pubsub import wait_until
from bench.ros2.endpoints import class_of, node, qos
from bench.ros2.messages import MESSAGES, WARM_UP, Message

_WARM_UP_S = 0.02
_SECOND = 1_000_000_000


def main() -> None:
    """Publish as the arguments say."""
    args = to_send(MESSAGES, ros=2)
    signal.alarm(args.limit)
    message = MESSAGES[args.message]
    pairs = [pair.split("=") for pair in args.publish]
    nodes = {name: node(name) for name, _ in pairs}
    publishers = [
        nodes[name].create_publisher(class_of(message.type), topic, qos()) for name, topic in pairs
    ]
    _warm_up(publishers, message)
    print(json.dumps(_send(publishers, message, args.count, args.rate)), flush=True)
    sys.stdin.readline()


def _warm_up(publishers: list[Any], message: Message) -> None:
    while not select.select([sys.stdin], [], [], _WARM_UP_S)[0]:
        for publisher in publishers:
            publisher.publish(message.stamped(time.monotonic_ns(), WARM_UP))
    sys.stdin.readline()


def _send(publishers: list[Any], message: Message, count: int, rate: int) -> dict[str, float]:
    start = time.monotonic_ns()
    latest = 0
    for number, publisher in zip(range(count), cycle(publishers), strict=False):
        latest = max(latest, wait_until(start + number * _SECOND // rate))
        publisher.publish(message.stamped(time.monotonic_ns(), number))
    seconds = (time.monotonic_ns() - start) / _SECOND
    return {"sent": count, "seconds": seconds, "late_ms": latest / 1e6}


if __name__ == "__main__":
    main()
