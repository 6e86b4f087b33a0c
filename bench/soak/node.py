"""A node of the soaked app: `python -m bench.soak.node ROS ROLE [FILE]`, on rospy or rclpy.

It imports nothing of RTron: rospy has a Python of its own. `base` hears what the navigation sends
and what the guard lets go, and writes them to FILE, with the times when it did not run itself;
`viewer` writes the time of each picture.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from collections.abc import Callable

COMMANDS, IMAGES = "/cmd_vel", "/camera/image"
FLOW, OUT = f"/rtron{COMMANDS}/flow1", f"/rtron{COMMANDS}/out"
IMAGE_FLOW, IMAGE_OUT = f"/rtron{IMAGES}/flow1", f"/rtron{IMAGES}/out"
SPEED, FORBIDDEN, INTRUDING = 0.5, 9.0, -0.25
"""What the navigation, who is not in the plan, and who goes past the guard say, m/s."""
RATE, INTRUDER_RATE, IMAGE_RATE = 20, 50, 10
IMAGE_BYTES = 10_000_000
TWIST, IMAGE = "geometry_msgs/Twist", "sensor_msgs/Image"
_NICE = 5
_QUEUE = 10
_TICK_S, _STALL_S = 0.005, 0.02


class Ros1Graph:
    """A node of rospy."""

    def __init__(self, name: str) -> None:
        import rospy  # noqa: PLC0415 - of one ROS only

        self._rospy = rospy
        rospy.init_node(name)

    def publish(self, topic: str, message: Any, rate: int) -> None:  # noqa: ANN401
        """Say a message again and again, `rate` times a second."""
        publisher = self._rospy.Publisher(topic, type(message), queue_size=_QUEUE, tcp_nodelay=True)
        period = self._rospy.Duration(1 / rate)
        self._rospy.Timer(period, lambda _: publisher.publish(message))

    def listen(self, topic: str, kind: Any, handler: Callable[[Any], None]) -> None:  # noqa: ANN401
        """Call `handler` with each message."""
        size = 1 << 25
        self._rospy.Subscriber(topic, kind, handler, tcp_nodelay=True, buff_size=size)

    def spin(self) -> None:
        """Run until told to end."""
        self._rospy.spin()


class Ros2Graph:
    """A node of rclpy."""

    def __init__(self, name: str) -> None:
        import rclpy  # noqa: PLC0415 - of one ROS only

        rclpy.init()
        self._rclpy = rclpy
        self._node = rclpy.create_node(name)

    def publish(self, topic: str, message: Any, rate: int) -> None:  # noqa: ANN401
        """Say a message again and again, `rate` times a second."""
        publisher = self._node.create_publisher(type(message), topic, _QUEUE)
        self._node.create_timer(1 / rate, lambda: publisher.publish(message))

    def listen(self, topic: str, kind: Any, handler: Callable[[Any], None]) -> None:  # noqa: ANN401
        """Call `handler` with each message."""
        self._node.create_subscription(kind, topic, handler, _QUEUE)

    def spin(self) -> None:
        """Run until told to end."""
        self._rclpy.spin(self._node)


Graph = Ros1Graph | Ros2Graph if sys.version_info >= (3, 10) else object


def main() -> None:
    """Be a node until told to end."""
    ros, role, *files = sys.argv[1:]
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: os._exit(0))
    graph = Ros1Graph(role) if ros == "1" else Ros2Graph(role)
    if role == "base":
        _write_commands(graph, Path(files[0]))
    elif role in _SPEAKERS:
        topics, speed, rate = _SPEAKERS[role]
        for topic in topics:
            graph.publish(topic, _twist(speed), rate)
    else:
        os.nice(_NICE)
        _handle_images(graph, files)
    graph.spin()


_SPEAKERS = {
    "nav": ((FLOW,), SPEED, RATE),
    "rogue": ((COMMANDS, FLOW), FORBIDDEN, RATE),
    "intruder": ((OUT,), INTRUDING, INTRUDER_RATE),
}


def _write_commands(graph: Any, path: Path) -> None:  # noqa: ANN401
    file = path.open("a", buffering=1)
    kind = type(_twist(0.0))

    def writer(side: str) -> Callable[[Any], None]:
        return lambda twist: file.write(f"{side} {time.monotonic_ns()} {twist.linear.x:g}\n")

    Thread(target=_write_stalls, args=[file], daemon=True).start()
    graph.listen(FLOW, kind, writer("in"))
    graph.listen(OUT, kind, writer("out"))


def _write_stalls(file: TextIO) -> None:
    """Write when this process did not run for a while, and for how long, s."""
    while True:
        begin = time.monotonic_ns()
        time.sleep(_TICK_S)
        stalled_s = (time.monotonic_ns() - begin) / 1e9 - _TICK_S
        if stalled_s > _STALL_S:
            file.write(f"stall {begin} {stalled_s:.3f}\n")


def _handle_images(graph: Any, files: list[str]) -> None:  # noqa: ANN401
    """See pictures and write when each came, or make them."""
    message = _message(IMAGE)
    if files:
        seen = Path(files[0]).open("a", buffering=1)  # noqa: SIM115 - as long as the process
        graph.listen(IMAGE_OUT, type(message), lambda _: seen.write(f"{time.monotonic_ns()}\n"))
        return
    message.height, message.width, message.encoding = 1, IMAGE_BYTES, "mono8"
    message.step, message.data = IMAGE_BYTES, bytes(IMAGE_BYTES)
    graph.publish(IMAGE_FLOW, message, IMAGE_RATE)


def _twist(speed: float) -> Any:  # noqa: ANN401
    twist = _message(TWIST)
    twist.linear.x = speed
    return twist


def _message(name: str) -> Any:  # noqa: ANN401
    package, _, kind = name.partition("/")
    return getattr(import_module(f"{package}.msg"), kind)()


if __name__ == "__main__":
    main()
