"""rclpy and the Python libraries of ROS 2 around it, as far as they join nodes."""

from rtron.sources.code.interpreter.abstract_values.value_types import (
    LibraryFunction,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclpy.libraries import LIBRARY_FUNCTIONS
from rtron.sources.code.library_models.rclpy.node import LIFECYCLE_NODE, NODE, make_node
from rtron.sources.code.library_models.rclpy.parameters import PARAMETER
from rtron.sources.code.library_models.rclpy.qos import library_profiles
from rtron.sources.code.library_models.rclpy.qos_overrides import OVERRIDING_CLASSES
from rtron.sources.code.library_models.rclpy.rosidl import ROSIDL


def _create_node(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    return make_node(machine, arguments)


def _is_running(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    return Unknown("ok")


def rclpy_library() -> dict[str, Value]:
    """Return what RTron knows of rclpy, for one program."""
    return {
        **{name: LibraryFunction(name, call) for name, call in LIBRARY_FUNCTIONS.items()},
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
        "rclpy.create_node": LibraryFunction("rclpy.create_node", _create_node),
        "rclpy.ok": LibraryFunction("rclpy.ok", _is_running),
    }
