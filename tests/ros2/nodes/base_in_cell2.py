"""A base with all that a cell may carry: FILE TOPIC. What it hears goes to the file.

It publishes /odom (Float64, counting), a latched /state and /unlisted; it hears Twists on TOPIC,
and /lamp, /map and /unlisted_in; it serves /reset, and calls /map_of until that answers: a server
drops its response if it meets the client's reader more than 100 ms later (rmw_fastrtps).
"""

import os
import sys
from pathlib import Path

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64, String
from std_srvs.srv import Trigger

_LEADING = ("FAST", "SKIP_DEFAULT_XML", "ROS_STATIC_PEERS", "CYCLONEDDS")
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def _leads(name):
    return name.startswith(_LEADING)


class Base:
    def __init__(self, node, path, topic):
        self.path, self.number, self.answer = path, 0, None
        self.odom = node.create_publisher(Float64, "/odom", 10)
        self.unlisted = node.create_publisher(Float64, "/unlisted", 10)
        self.state = node.create_publisher(Float64, "/state", LATCHED)
        node.create_subscription(Twist, topic, self.drive, 10)
        for name, qos in (("/lamp", 10), ("/unlisted_in", 10), ("/map", LATCHED)):
            node.create_subscription(
                String, name, lambda heard, name=name: self.write(name, heard.data), qos
            )
        node.create_service(Trigger, "/reset", self.reset)
        self.client = node.create_client(Trigger, "/map_of")
        node.declare_parameter("wheel", 1.0)
        self.node = node
        node.create_timer(0.05, self.tell)
        self.state.publish(Float64(data=7.0))
        self.write("environ", *sorted(f"{n}={v}" for n, v in os.environ.items() if _leads(n)))

    def write(self, *words):
        with Path(self.path).open("a") as file:
            print(*words, file=file, flush=True)

    def drive(self, twist):
        self.write("drive", twist.linear.x, twist.angular.z)

    def reset(self, _request, answer):
        self.write("reset")
        answer.success, answer.message = True, "was reset"
        return answer

    def tell(self):
        self.number += 1
        self.odom.publish(Float64(data=float(self.number)))
        self.unlisted.publish(Float64(data=float(self.number)))
        if self.number % 20 == 0:
            self.ask()
            self.write("wheel", self.node.get_parameter("wheel").value)

    def ask(self):
        if self.answer is not None and self.answer.done():
            return
        if self.client.service_is_ready():
            if self.answer is not None:
                self.client.remove_pending_request(self.answer)
            self.answer = self.client.call_async(Trigger.Request())
            self.answer.add_done_callback(lambda done: self.write("map", done.result().message))


def main():
    rclpy.init()
    path, topic = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    base = Base(rclpy.create_node("base"), path, topic)
    try:
        rclpy.spin(base.node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
