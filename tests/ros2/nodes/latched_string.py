"""Publishes one latched String, before anybody listens: TOPIC TEXT."""

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String
from topic_endpoints import LATCHED


def main():
    rclpy.init()
    topic, text = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    node = rclpy.create_node("speaker")
    node.create_publisher(String, topic, LATCHED).publish(String(data=text))
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
