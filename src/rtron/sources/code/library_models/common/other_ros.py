"""What a program uses of the other ROS: it joins nothing there, and this is noted."""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    LibraryClass,
    LibraryFunction,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

OTHER_PYTHON_LIBRARY: Mapping[int, str] = {1: "rclpy", 2: "rospy"}
"""The client library of the other ROS, by the ROS of a launch."""


def other_ros_reason(ros: int) -> str:
    """Return why a node of a ROS joins nothing through the library of the other one."""
    return f"it is of ROS {3 - ros}, and the launch of ROS {ros}: what is joined by it is missing"


def _note(name: str, machine: AbstractMachine, at: Arguments) -> None:
    why = other_ros_reason(machine.recorder.site.ros)
    machine.recorder.add_unresolved(name, why, at.evidence)


def _call(name: str, machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    _note(name, machine, arguments)
    return NONE


def _make(name: str, machine: AbstractMachine, arguments: Arguments) -> Value:
    _note(name, machine, arguments)
    return Instance(LibraryClass(name))


_NODES = {1: ("rclcpp::init", "rclcpp::Node"), 2: ("ros::init", "ros::NodeHandle")}
"""What a C++ program of the other ROS begins with, by the ROS of a launch."""
OTHER_CPP_FUNCTIONS: Mapping[int, Mapping[str, LibraryFunction]] = {
    ros: {name: LibraryFunction(name, partial(_call, name))} for ros, (name, _) in _NODES.items()
}
OTHER_CPP_CLASSES: Mapping[int, Mapping[str, LibraryClass]] = {
    ros: {name: LibraryClass(name, partial(_make, name))} for ros, (_, name) in _NODES.items()
}
