"""Publishes Twists whose speeds count from 1 on: TOPIC RATE."""

import sys
from itertools import count

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException


def main():
    rclpy.init()
    topic, rate = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    node = rclpy.create_node("counter")
    publisher = node.create_publisher(Twist, topic, 10)
    message, numbers = Twist(), count(1)

    def say():
        message.linear.x = float(next(numbers))
        publisher.publish(message)

    node.create_timer(1 / float(rate), say)
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
