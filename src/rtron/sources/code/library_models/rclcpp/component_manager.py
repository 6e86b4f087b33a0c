"""Containers that a program makes itself (rclcpp_components: ComponentManager)."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import Instance, Known, NativeClass
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclcpp.node import NODE, bare_options, make_node
from rtron.sources.code.library_models.ros2_common import endpoints

MANAGER = "ComponentManager"
"""What a container is called that nobody names."""
LOADING: Mapping[str, str] = {
    "_container/load_node": "composition_interfaces/srv/LoadNode",
    "_container/unload_node": "composition_interfaces/srv/UnloadNode",
    "_container/list_nodes": "composition_interfaces/srv/ListNodes",
}
"""docs.ros.org: "Composing multiple nodes in a single process"."""


def _make(machine: Machine, arguments: Arguments) -> Instance:
    """`ComponentManager(executor[, name][, options])`."""
    name = arguments.get(1) or Known(MANAGER)
    options = arguments.get(2) or bare_options(machine, arguments)
    given = Arguments(values=(name, options), line=arguments.line, frame=arguments.frame)
    made = make_node(machine, given)
    endpoints.services(machine, made, LOADING, arguments)
    return made


COMPONENT_CLASSES: Mapping[str, NativeClass] = {
    name: NativeClass(name, _make, dict(NODE.methods))
    for name in (f"rclcpp_components::{MANAGER}", f"rclcpp_components::{MANAGER}Isolated")
}
