"""Publishes and subscribes what its arguments say: `>/topic:pkg/Type` and `</topic:pkg/Type`.

A publisher says zeros ten times a second; `@qos` behind a type is `sensor` or `latched`.
"""

import sys
from importlib import import_module

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
PROFILES = {"": QoSProfile(depth=10), "sensor": qos_profile_sensor_data, "latched": LATCHED}


def type_of(text):
    package, name = text.split("/")
    return getattr(import_module(f"{package}.msg"), name)


def open_end(node, argument):
    topic, _, rest = argument[1:].partition(":")
    kind, _, profile = rest.partition("@")
    kind = type_of(kind or "std_msgs/String")
    if argument[0] == "<":
        node.create_subscription(kind, topic, print, PROFILES[profile])
        return
    publisher = node.create_publisher(kind, topic, PROFILES[profile])
    node.create_timer(0.1, lambda: publisher.publish(kind()))


def main():
    rclpy.init()
    node = rclpy.create_node("ends")
    for argument in rclpy.utilities.remove_ros_args(sys.argv)[1:]:
        open_end(node, argument)
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
