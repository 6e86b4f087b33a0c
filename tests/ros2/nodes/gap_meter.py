"""Tells how many messages came on topics, and the longest gap between two: TOPIC=TYPE ..."""

import sys
import time
from importlib import import_module

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSProfile


class Meter:
    """Counts the messages of one topic and keeps their longest gap, in seconds."""

    def __init__(self, topic):
        self.topic, self.count, self.longest, self.last = topic, 0, 0.0, None

    def hear(self, _):
        now = time.monotonic()
        self.longest = max(self.longest, now - (self.last or now))
        self.last, self.count = now, self.count + 1

    def tell(self):
        print(f"heard {self.topic} {self.count} {self.longest:.4f}")


def main():
    rclpy.init()
    node = rclpy.create_node("meter")
    meters = []
    for each in rclpy.utilities.remove_ros_args(sys.argv)[1:]:
        topic, _, type = each.partition("=")
        package, _, name = type.partition("/")
        meter = Meter(topic)
        message = getattr(import_module(f"{package}.msg"), name)
        node.create_subscription(message, topic, meter.hear, QoSProfile(depth=10))
        meters.append(meter)
    node.create_timer(0.2, lambda: [meter.tell() for meter in meters])
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
