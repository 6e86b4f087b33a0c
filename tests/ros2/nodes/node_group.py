"""Several nodes in one process: `NAME` begins a node, the words behind it are its ends.

`>/topic:pkg/Type` publishes, `</topic:pkg/Type` subscribes (`@sensor`, `@latched`: the QoS),
`+/service` offers and `-/service` can call a std_srvs/Trigger, `!/action` offers and `?/action` can
ask for a test_msgs/Fibonacci.
"""

import sys

import rclpy
from rclpy.action import ActionClient, ActionServer
from std_srvs.srv import Trigger
from topic_endpoints import PROFILES, type_of


def fibonacci():
    from test_msgs.action import Fibonacci  # noqa: PLC0415 - it takes a second to load

    return Fibonacci


def publish(node, topic, kind, profile):
    return node.create_publisher(type_of(kind), topic, PROFILES[profile])


def subscribe(node, topic, kind, profile):
    return node.create_subscription(type_of(kind), topic, print, PROFILES[profile])


OPEN = {
    ">": publish,
    "<": subscribe,
    "+": lambda node, name, *_: node.create_service(Trigger, name, lambda _, answer: answer),
    "-": lambda node, name, *_: node.create_client(Trigger, name),
    "!": lambda node, name, *_: ActionServer(node, fibonacci(), name, print),
    "?": lambda node, name, *_: ActionClient(node, fibonacci(), name),
}


def main():
    rclpy.init()
    node, kept = None, []
    for word in sys.argv[1:]:
        if word[0] in OPEN:
            name, _, rest = word[1:].partition(":")
            kept.append(OPEN[word[0]](node, name, *rest.partition("@")[::2]))
        else:
            space, _, base = word.rpartition("/")
            node = rclpy.create_node(base, namespace=space)
            kept.append(node)
    print("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
