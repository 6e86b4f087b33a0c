"""rclpy and the Python libraries of ROS 2 around it, as far as they join nodes."""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.ros_arguments import remove_ros_arguments
from rtron.sources.code.library_models.common.trivial_functions import returning_unknown
from rtron.sources.code.library_models.rclpy.libraries import LIBRARY_FUNCTIONS
from rtron.sources.code.library_models.rclpy.node import LIFECYCLE_NODE, NODE, make_node
from rtron.sources.code.library_models.rclpy.parameters import PARAMETER
from rtron.sources.code.library_models.rclpy.qos import OVERRIDING_CLASSES, library_profiles

_PARTS = 3
_FOLDERS = {
    "get_message": {"msg"},
    "get_service": {"srv"},
    "get_action": {"action"},
    "get_interface": {"msg", "srv", "action"},
}


def _get_interface(
    folders: set[str], _: AbstractMachine, __: object, arguments: Arguments
) -> av.Value:
    """`get_message("std_msgs/msg/String")`."""

    def named(value: av.Value) -> av.Value:
        name = value.value if isinstance(value, av.Scalar) else None
        parts = name.split("/") if isinstance(name, str) else []
        is_full = len(parts) == _PARTS and all(parts) and parts[1] in folders
        return av.MessageType("/".join(parts)) if is_full else av.Unknown("interface")

    return av.map_options(arguments.value(0, "identifier"), named)


ROSIDL: Mapping[str, av.Value] = {
    f"rosidl_runtime_py.utilities.{name}": av.LibraryFunction(
        name, partial(_get_interface, folders)
    )
    for name, folders in _FOLDERS.items()
}


def _launch_service(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`launch.LaunchService()`: what it includes, `rtron scan` reads where it is named."""
    why = "what a node launches itself is not followed: name its launch file with --launch too"
    machine.recorder.add_unresolved("launch.LaunchService()", why, arguments.evidence)
    return av.Unknown("LaunchService")


def _create_node(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    return make_node(machine, arguments)


def rclpy_library() -> dict[str, av.Value]:
    """Return what RTron knows of rclpy, for one program."""
    return {
        **{name: av.LibraryFunction(name, call) for name, call in LIBRARY_FUNCTIONS.items()},
        **library_profiles(),
        **ROSIDL,
        **OVERRIDING_CLASSES,
        **dict.fromkeys(("rclpy.node.Node", "rclpy.Node"), NODE),
        **dict.fromkeys(
            (
                *("rclpy.lifecycle.Node", "rclpy.lifecycle.LifecycleNode"),
                *("rclpy.lifecycle.node.LifecycleNode", "rclpy.lifecycle.node.Node"),
            ),
            LIFECYCLE_NODE,
        ),
        **dict.fromkeys(("rclpy.parameter.Parameter", "rclpy.Parameter"), PARAMETER),
        "rclpy.create_node": av.LibraryFunction("rclpy.create_node", _create_node),
        "launch.LaunchService": av.LibraryFunction("launch.LaunchService", _launch_service),
        **dict.fromkeys(
            ("rclpy.utilities.remove_ros_args", "rclpy.remove_ros_args"),
            av.LibraryFunction("remove_ros_args", remove_ros_arguments),
        ),
        "rclpy.ok": av.LibraryFunction("rclpy.ok", returning_unknown("ok")),
    }
