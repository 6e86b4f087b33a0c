"""Controllers of ros2_control, as their classes make them (control.ros.org: controller_interface).

A controller is an object that has a node, made before `on_init`; its manager calls the rest.
"""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclcpp.node import controller_options, make_node
from rtron.sources.code.library_models.rclcpp.parameters import declare_parameter

_NODE = "controller.node"
_CONTROLLER_CALLBACKS = ("on_init", "on_configure", "on_activate")
_BASES = ("ControllerInterfaceBase", "ControllerInterface", "ChainableControllerInterface")


def _make_controller(name: str, machine: AbstractMachine, arguments: Arguments) -> Instance:
    """Make a controller's node, which its spawner names; it has no services of its lifecycle."""
    words = (Scalar("controller"), Scalar(""), controller_options(machine, arguments), FALSE)
    given = Arguments(values=words, line=arguments.line, frame=arguments.frame)
    node = make_node(machine, given, lifecycle=True)
    return Instance(CONTROLLER_CLASSES[name], {_NODE: node})


def _get_node(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get(_NODE, Unknown("get_node()"))


def _auto_declare(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`auto_declare<T>(name, default)`."""
    return declare_parameter(machine, owner.fields.get(_NODE, Unknown("node")), arguments)


def _succeed(_: AbstractMachine, __: Instance, ___: Arguments) -> Value:
    return Unknown("CallbackReturn::SUCCESS")


CONTROLLER_CLASSES: Mapping[str, LibraryClass] = {
    name: LibraryClass(
        name,
        partial(_make_controller, name),
        {
            "get_node": _get_node,
            "auto_declare": _auto_declare,
            **dict.fromkeys(_CONTROLLER_CALLBACKS, _succeed),
        },
        virtual_callbacks=_CONTROLLER_CALLBACKS,
    )
    for name in (f"controller_interface::{base}" for base in _BASES)
}
