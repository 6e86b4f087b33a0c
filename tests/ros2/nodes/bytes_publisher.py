"""Publishes arrays of bytes on a topic, and tells after each 50: TOPIC BYTES RATE."""

import sys
from array import array
from itertools import count

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSProfile
from std_msgs.msg import UInt8MultiArray


def main():
    rclpy.init()
    topic, size, rate = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    node = rclpy.create_node("scanner")
    publisher = node.create_publisher(UInt8MultiArray, topic, QoSProfile(depth=5))
    message = UInt8MultiArray(data=array("B", bytes(int(size))))
    numbers = count(1)

    def say():
        publisher.publish(message)
        if next(numbers) % 50 == 0:
            print("sent 50 more", flush=True)

    node.create_timer(1 / float(rate), say)
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
