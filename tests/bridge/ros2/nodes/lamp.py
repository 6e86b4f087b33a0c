"""A lamp: serves /lamp (std_srvs/SetBool), and prints and publishes what is said on /chat."""

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String
from std_srvs.srv import SetBool


def switch(request, response):
    response.success = request.data
    response.message = "on" if request.data else "off"
    return response


def main():
    rclpy.init()
    node = rclpy.create_node("lamp")
    node.declare_parameter("speed", 0.5)
    node.declare_parameter("names", ["a", "ä"])
    node.create_service(SetBool, "/lamp", switch)
    node.create_subscription(String, "/chat", lambda told: print("chat", told.data), 10)
    topic = node.create_publisher(String, "/light", 10)
    node.create_timer(0.1, lambda: topic.publish(String(data="grün")))
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
