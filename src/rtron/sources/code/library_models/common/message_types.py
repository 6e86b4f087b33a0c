"""Message types as source names them, in Python and C++."""

import re
from collections.abc import Mapping
from functools import partial
from typing import Any

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import TypeRef

_PYTHON_MODULES = {"msg", "srv"}
INTERFACE_FOLDERS = {"msg", "srv", "action"}
_POINTER_TYPES = {
    *("boost::shared_ptr", "std::shared_ptr", "shared_ptr", "boost::shared_ptr const"),
    *("ros::MessageEvent", "MessageEvent", "message_filters::MessageEvent", "std::unique_ptr"),
    *("unique_ptr", "rclcpp::LoanedMessage"),
}
_NON_MESSAGE_NAMESPACES = {"std", "boost", "ros", "cv", "Eigen", "pcl", "tf", "tf2"}
MESSAGES_WITH_CHILD = ("geometry_msgs/TransformStamped", "nav_msgs/Odometry")
HEADER = av.LibraryClass("std_msgs/Header")
_SUFFIXES = (
    *("ConstSharedPtr", "ConstUniquePtr", "ConstWeakPtr", "ConstPtr"),
    *("SharedPtr", "UniquePtr", "WeakPtr", "Ptr", "Request", "Response"),
)

_WORD_START = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=.)(?=[A-Z][a-z])")
"""Where a word begins in a type's name (rosidl_pycommon's rule for the names of headers)."""


def is_message_package(dotted: str) -> bool:
    """Tell whether a Python module is one of generated messages: `std_msgs.msg`."""
    return dotted.rpartition(".")[2] in _PYTHON_MODULES and dotted.count(".") == 1


def python_message_type(dotted: str) -> av.MessageType | None:
    """Return the type that `std_msgs.msg.String` means; None for any other name."""
    parts = dotted.split(".")
    if len(parts) == 3 and parts[1] in _PYTHON_MODULES and parts[2][:1].isalpha():  # noqa: PLR2004
        return av.MessageType(f"{parts[0]}/{parts[2]}")
    return None


def cpp_message_type(type: TypeRef | None) -> str:
    """Return the message that a C++ type means: `std_msgs::String::ConstPtr` is std_msgs/String.

    In ROS 2, `std_msgs::msg::String::SharedPtr` is std_msgs/msg/String.

    A point cloud of PCL travels as a PointCloud2 (ROS wiki: pcl_ros).

    Empty for what does not look like a message of a package.
    """
    if type is None:
        return ""
    if type.name in _POINTER_TYPES and type.args:
        return cpp_message_type(type.args[0])
    if type.name.startswith("pcl::PointCloud"):
        return "sensor_msgs/PointCloud2"
    parts = [part for part in type.name.split("::") if part]
    if len(parts) > 2 and parts[1] in INTERFACE_FOLDERS:  # noqa: PLR2004
        return "/".join(parts[:3])
    if len(parts) > 2 and parts[-1] in _SUFFIXES:  # noqa: PLR2004
        parts.pop()
    if len(parts) != 2 or parts[0] in _NON_MESSAGE_NAMESPACES or parts[1] in _SUFFIXES:  # noqa: PLR2004
        return ""
    return f"{parts[0]}/{cpp_message_name(parts[1])}"


def cpp_message_name(name: str) -> str:
    """Return a message's name without what C++ adds to it: `StringConstPtr` is String."""
    name = name.removesuffix("_")
    for suffix in _SUFFIXES:
        if name.endswith(suffix) and name != suffix:
            return name.removesuffix(suffix)
    return name


def message_header(package: str, folder: str, name: str) -> str:
    """Return the header of a type: `std_msgs/String.h`; of ROS 2, `std_msgs/msg/my_text.hpp`."""
    if not folder:
        return f"{package}/{name}.h"
    return f"{package}/{folder}/{_WORD_START.sub('_', name).lower()}.hpp"


def make_message(name: str, fields: dict[Any, av.Value]) -> av.Instance:
    """Return a message with some fields; one that names a child frame has a header too."""
    if name in MESSAGES_WITH_CHILD:
        fields.setdefault("header", av.Instance(HEADER))
    return av.Instance(av.LibraryClass(name), fields)


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
