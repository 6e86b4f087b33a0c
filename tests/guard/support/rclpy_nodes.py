"""Nodes of rclpy beside a guard in a ROS 2 domain, in the process of the test."""

import struct

from harness import wait_for
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile

from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import Ros2Session

TWIST, STRING, IMAGE = "geometry_msgs/msg/Twist", "std_msgs/msg/String", "sensor_msgs/msg/Image"


def twist(speed):
    """Return a Twist as CDR."""
    return b"\0\1\0\0" + struct.pack("<6d", speed, 0, 0, 0, 0, 0)


def kept(depth):
    """Return the profile of one who keeps its last words, or wants those that were kept."""
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RclpyParticipant:
    """Nodes of rclpy that publish and hear raw bytes."""

    def __init__(self, domain):
        self._session = Ros2Session(domain)
        self._executor = SingleThreadedExecutor(context=self._session.context)
        self._nodes = set()

    def close(self):
        self._executor.shutdown()
        self._session.close()

    def publisher(self, name, topic, type=TWIST, profile=10):
        return self.node(name).create_publisher(find_interface(type).cls, topic, profile)

    def listener(self, name, topic, type=TWIST, profile=1000):
        heard = []
        cls = find_interface(type).cls
        silent = SubscriptionEventCallbacks(use_default_callbacks=False)
        self.node(name).create_subscription(
            cls, topic, heard.append, profile, raw=True, event_callbacks=silent
        )
        return heard

    def wait_for(self, condition, what):
        wait_for(lambda: self._executor.spin_once(timeout_sec=0.01) or condition(), what=what)

    def say_until(self, publisher, message, condition, what):
        """Say a message again and again until it has had its effect."""

        def noticed():
            publisher.publish(message)
            return condition()

        self.wait_for(noticed, what)

    def node(self, name):
        """Return the node of this name."""
        node = self._session.node(name)
        if name not in self._nodes:
            self._nodes.add(name)
            self._executor.add_node(node)
        return node
