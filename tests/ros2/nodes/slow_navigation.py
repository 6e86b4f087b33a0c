"""Navigates: counts up in mm/s at RATE on TOPIC, and turns left as nothing else does.

It is slow: from metres a second that it counted up to, every stop would be a ramp of seconds.
"""

import sys
from itertools import count

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException


def main():
    rclpy.init()
    topic, rate = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    node = rclpy.create_node("nav")
    publisher = node.create_publisher(Twist, topic, 10)
    message, numbers = Twist(), count(1)
    message.angular.z = 0.5

    def say():
        message.linear.x = next(numbers) / 1000
        publisher.publish(message)

    node.create_timer(1 / float(rate), say)
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
