"""Calls a service once it is there, and prints the answer: TYPE SERVICE [FIELD=WORDS]."""

import sys
from importlib import import_module

import rclpy
from rclpy.executors import ExternalShutdownException


def main():
    rclpy.init()
    kind, service, *fields = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    package, name = kind.split("/")
    cls = getattr(import_module(f"{package}.srv"), name)
    node = rclpy.create_node("client")
    client = node.create_client(cls, service)
    request = cls.Request()
    for name, words in (field.split("=") for field in fields):
        setattr(request, name, words.split())
    print("ready")
    try:
        client.wait_for_service()
        client.call_async(request).add_done_callback(lambda done: print("answer", done.result()))
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()
