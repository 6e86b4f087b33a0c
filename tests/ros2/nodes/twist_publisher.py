"""Publishes Twists on a topic: TOPIC SPEED RATE [COUNT] [reliable|best_effort|latched].

Without COUNT it goes on for ever; `latched` says one thing only, before anybody listens.
"""

import sys

import rclpy
from geometry_msgs.msg import Twist
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

PROFILES = {
    "reliable": QoSProfile(depth=10),
    "best_effort": QoSProfile(
        depth=5, reliability=ReliabilityPolicy.BEST_EFFORT, deadline=Duration(seconds=2)
    ),
    "latched": QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
}


def main():
    rclpy.init()
    topic, speed, rate, count, profile = (*rclpy.utilities.remove_ros_args(sys.argv)[1:], "", "")[
        :5
    ]
    node = rclpy.create_node("speaker")
    publisher = node.create_publisher(Twist, topic, PROFILES[profile or "reliable"])
    message = Twist()
    message.linear.x = float(speed)
    left = int(count or 1 << 62)

    def say():
        nonlocal left
        if left:
            left -= 1
            publisher.publish(message)
        elif left == 0:
            left = None
            print("said all")

    node.create_timer(1 / float(rate), say)
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
