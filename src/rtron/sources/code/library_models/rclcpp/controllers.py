"""Controllers of ros2_control, as their classes make them (control.ros.org: controller_interface).

A controller is an object that has a node, made before `on_init`; its manager calls the rest.
"""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclcpp.node import declaring_options, make_node
from rtron.sources.code.library_models.rclcpp.parameters import declare_parameter

_NODE = "controller.node"
_CALLED = ("on_init", "on_configure", "on_activate")
_BASES = ("ControllerInterfaceBase", "ControllerInterface", "ChainableControllerInterface")


def _make(name: str, machine: Machine, arguments: Arguments) -> Instance:
    """Make a controller's node, which its spawner names; it has no services of its lifecycle."""
    words = (Known("controller"), Known(""), declaring_options(machine, arguments), FALSE)
    given = Arguments(values=words, line=arguments.line, frame=arguments.frame)
    node = make_node(machine, given, lifecycle=True)
    return Instance(CONTROLLER_CLASSES[name], {_NODE: node})


def _get_node(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get(_NODE, Hole("get_node()"))


def _declare(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`auto_declare<T>(name, default)`."""
    return declare_parameter(machine, owner.fields.get(_NODE, Hole("node")), arguments)


def _succeed(_: Machine, __: Instance, ___: Arguments) -> Value:
    return Hole("CallbackReturn::SUCCESS")


CONTROLLER_CLASSES: Mapping[str, NativeClass] = {
    name: NativeClass(
        name,
        partial(_make, name),
        {"get_node": _get_node, "auto_declare": _declare, **dict.fromkeys(_CALLED, _succeed)},
        called=_CALLED,
    )
    for name in (f"controller_interface::{base}" for base in _BASES)
}
