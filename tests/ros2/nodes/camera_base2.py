"""A robot that says in one order what it films (/image) and what it is told: TOPIC."""

import sys

import rclpy
from film import RATE, Film, say, say_speed
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import Image


def main():
    rclpy.init()
    (topic,) = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    node = rclpy.create_node("robot")
    camera, picture = node.create_publisher(Image, "/image", 10), Image()

    def take():
        picture.header.stamp = node.get_clock().now().to_msg()
        camera.publish(picture)

    node.create_subscription(Twist, topic, say_speed, 1000)
    node.create_timer(1 / RATE, Film(take).tick)
    say("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
