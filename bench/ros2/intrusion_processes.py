"""The processes of an intrusion on ROS 2: `python -m bench.ros2.intrusion_processes WHAT ...`.

`navigation`; `base FILE`, which writes the time (ns of the steady clock) and angular.z of every
message to FILE; `intrude RATE NODE TOPIC`: a stranger on a topic, with this node name.
"""

import signal
import sys
import time
from pathlib import Path

from geometry_msgs.msg import Twist
from rclpy.executors import SingleThreadedExecutor

from bench.common.intrusion import DRIVER, INTRUDER, NAVIGATION
from bench.common.pubsub import PUBLISHER
from bench.ros2.audit import FLOW, OUT
from rtron.wire.ros2.session import Ros2Session

_NAVIGATION_S = 0.1


def main() -> None:
    """Be a process of the app or the intruder until told to end."""
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: sys.exit())
    session = Ros2Session(enclave="/")
    executor = SingleThreadedExecutor(context=session.context)
    executor.add_node(session.node(_take_part(session, *sys.argv[1:])))
    executor.spin()


def _take_part(session: Ros2Session, what: str, *arguments: str) -> str:
    """Publish or subscribe as the arguments say; return the node's name."""
    if what == "base":
        _write_messages(session, Path(*arguments))
        return DRIVER
    if what == "navigation":
        _publish(session, PUBLISHER, FLOW, NAVIGATION, _NAVIGATION_S)
        return PUBLISHER
    rate, node, topic = arguments
    _publish(session, node, topic, INTRUDER, 1 / int(rate))
    return node


def _publish(session: Ros2Session, node: str, topic: str, turn: float, period_s: float) -> None:
    publisher = session.node(node).create_publisher(Twist, topic, 10)
    message = Twist()
    message.angular.z = turn
    session.node(node).create_timer(period_s, lambda: publisher.publish(message))


def _write_messages(session: Ros2Session, path: Path) -> None:
    file = path.open("a", buffering=1)

    def heard(twist: Twist) -> None:
        file.write(f"{time.monotonic_ns()} {twist.angular.z:g}\n")

    session.node(DRIVER).create_subscription(Twist, OUT, heard, 10)


if __name__ == "__main__":
    main()
