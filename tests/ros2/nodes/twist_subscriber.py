"""A motor driver: prints the speed of every Twist on a topic. TOPIC [reliable|...|latched]."""

import sys

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from twist_publisher import PROFILES


def main():
    rclpy.init()
    topic, profile = (*rclpy.utilities.remove_ros_args(sys.argv)[1:], "")[:2]
    node = rclpy.create_node("driver")
    node.create_subscription(
        Twist, topic, lambda twist: print("speed", twist.linear.x), PROFILES[profile or "reliable"]
    )
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
