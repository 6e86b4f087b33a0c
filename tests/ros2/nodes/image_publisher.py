"""Publishes pictures on a topic: TOPIC BYTES RATE."""

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Image


def main():
    rclpy.init()
    topic, size, rate = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    node = rclpy.create_node("camera")
    publisher = node.create_publisher(Image, topic, QoSProfile(depth=5))
    message = Image(height=1, width=int(size), step=int(size), encoding="mono8")
    message.data = bytes(int(size))

    def say():
        message.header.stamp = node.get_clock().now().to_msg()
        publisher.publish(message)

    node.create_timer(1 / float(rate), say)
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
