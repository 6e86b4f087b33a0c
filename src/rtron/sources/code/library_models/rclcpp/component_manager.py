"""Containers that a program makes itself (rclcpp_components: ComponentManager)."""

from collections.abc import Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclcpp.node import NODE, container_options, make_node
from rtron.sources.code.library_models.ros2_common import endpoints

DEFAULT_CONTAINER_NAME = "ComponentManager"
"""What a container without a name is called."""
CONTAINER_SERVICES: Mapping[str, str] = {
    "_container/load_node": "composition_interfaces/srv/LoadNode",
    "_container/unload_node": "composition_interfaces/srv/UnloadNode",
    "_container/list_nodes": "composition_interfaces/srv/ListNodes",
}
"""docs.ros.org: "Composing multiple nodes in a single process"."""


def _make_component_manager(machine: AbstractMachine, arguments: Arguments) -> av.Instance:
    """`ComponentManager(executor[, name][, options])`."""
    name = arguments.get(1) or av.Scalar(DEFAULT_CONTAINER_NAME)
    options = arguments.get(2) or container_options(machine, arguments)
    given = arguments.with_values(name, options)
    made = make_node(machine, given)
    endpoints.declare_services(machine, made, CONTAINER_SERVICES, arguments)
    return made


COMPONENT_CLASSES: Mapping[str, av.LibraryClass] = {
    name: av.LibraryClass(name, _make_component_manager, dict(NODE.methods))
    for name in (
        f"rclcpp_components::{DEFAULT_CONTAINER_NAME}",
        f"rclcpp_components::{DEFAULT_CONTAINER_NAME}Isolated",
    )
}
