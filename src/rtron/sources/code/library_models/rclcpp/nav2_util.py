"""What Nav2's library nav2_util (since Kilted nav2_ros_common) adds to nodes of others.

Sources: github.com/ros-navigation/navigation2@6cee761, nav2_util/service_client.hpp,
simple_action_server.hpp and lifecycle_node.hpp.
"""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    TRUE,
    Instance,
    LibraryClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import template_message_type
from rtron.sources.code.library_models.rclcpp.endpoints import NO_OWNER, create_endpoint
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.nodes import first_node
from rtron.sources.declaration import DeclarationKind


def _service_client(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`ServiceClient<T>(service, node)`."""
    node, name = first_node(arguments.values), arguments.get(0)
    kind = DeclarationKind.SERVICE_CLIENT
    if node is None:
        endpoints.note_unknown_node(machine, kind.value, name, arguments)
    else:
        type = template_message_type(machine, arguments)
        endpoints.declare_endpoint(machine, kind, node, name, type, arguments)
    return Instance(_SERVICE_CLIENT, {"truth": TRUE})


def _action_server(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`SimpleActionServer<T>(node, action, execute, …)`."""
    create_endpoint(DeclarationKind.ACTION_SERVER, machine, NO_OWNER, arguments)
    return Instance(_ACTION_SERVER, {"truth": TRUE})


_SERVICE_CLIENT = LibraryClass("nav2_util::ServiceClient", _service_client)
_ACTION_SERVER = LibraryClass("nav2_util::SimpleActionServer", _action_server)
NAV2_CLASSES: Mapping[str, LibraryClass] = {
    f"{space}::{cls.name.rpartition('::')[2]}": cls
    for cls in (_SERVICE_CLIENT, _ACTION_SERVER)
    for space in ("nav2_util", "nav2")
}
