"""Endpoints of plain rclpy for the processes that send and listen on ROS 2."""

from importlib import import_module
from typing import Any

from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile

from bench.ros2.messages import DEPTH


def node(name: str) -> Node:
    """Return a node with a participant of its own; `name` is its full name."""
    context = Context()
    context.init(args=[])
    space, _, base = name.rpartition("/")
    return Node(base, context=context, namespace=space, enable_rosout=False)


def class_of(type: str) -> Any:  # noqa: ANN401 - rclpy has no types
    """Return the class of a type, `pkg/msg/Name`."""
    package, kind, name = type.split("/")
    return getattr(import_module(f"{package}.{kind}"), name)


def qos() -> QoSProfile:
    """Return what every end of a measured way asks for or offers: reliable, nothing kept."""
    return QoSProfile(depth=DEPTH)
