"""What a program uses of the other ROS: it joins nothing there, and this is noted."""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
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


def _call(name: str, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    _note(name, machine, arguments)
    return av.NONE


def _make(name: str, machine: AbstractMachine, arguments: Arguments) -> av.Value:
    _note(name, machine, arguments)
    return av.Instance(av.LibraryClass(name))


_NODES = {1: ("rclcpp::init", "rclcpp::Node"), 2: ("ros::init", "ros::NodeHandle")}
"""What a C++ program of the other ROS begins with, by the ROS of a launch."""
OTHER_CPP_FUNCTIONS: Mapping[int, Mapping[str, av.LibraryFunction]] = {
    ros: {name: av.LibraryFunction(name, partial(_call, name))} for ros, (name, _) in _NODES.items()
}
OTHER_CPP_CLASSES: Mapping[int, Mapping[str, av.LibraryClass]] = {
    ros: {name: av.LibraryClass(name, partial(_make, name))} for ros, (_, name) in _NODES.items()
}
