"""nav2_util, and nav2_ros_common after it: the nodes, clients and servers that others derive.

Sources: navigation2, nav2_util (lifecycle_node.hpp, service_client.hpp, simple_action_server.hpp,
lifecycle_service_client.hpp, node_utils.hpp) and nav2_ros_common. Their source counts before.
"""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclcpp.endpoints import (
    NO_OWNER,
    create_endpoint,
    split_node,
)
from rtron.sources.code.library_models.rclcpp.libraries import declare_bond
from rtron.sources.code.library_models.rclcpp.node import LIFECYCLE_NODE, make_node
from rtron.sources.code.library_models.rclcpp.parameters import declare_parameter
from rtron.sources.code.library_models.ros2_common import endpoints, parameters
from rtron.sources.code.library_models.ros2_common.nodes import first_node
from rtron.sources.declaration import DeclarationKind

_NAMESPACES = ("nav2_util", "nav2")
_TRANSITION_SERVICES = {
    "change_state": "lifecycle_msgs/srv/ChangeState",
    "get_state": "lifecycle_msgs/srv/GetState",
}


def _create_bond(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`createBond()`: with the node's lifecycle manager."""
    declare_bond(machine, arguments.with_values(av.Scalar("bond"), av.UNKNOWN, owner))
    return av.NONE


def _declare_or_get(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_or_get_parameter(name, default)`."""
    name = arguments.value(0)
    if parameters.is_declared(machine, owner, name):
        return parameters.read_node_parameter(machine, owner, name)
    return declare_parameter(machine, owner, arguments)


def _make_client(
    kind: DeclarationKind, at: int, machine: AbstractMachine, arguments: Arguments
) -> av.Value:
    """`ServiceClient<T>(name, node)`, `ServiceServer<T>(name, node, callback)`: name first."""
    node, name = first_node(arguments.values[at:]), arguments.get(0)
    if node is None:
        endpoints.note_unknown_node(machine, kind.value, name, arguments)
        return av.UNKNOWN
    return create_endpoint(kind, machine, node, arguments)


def _make_transition_client(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`LifecycleServiceClient(node_name, node)`."""
    kind, node = DeclarationKind.SERVICE_CLIENT, first_node(arguments.values[1:])
    for service, type in _TRANSITION_SERVICES.items():
        name = av.concat((arguments.value(0), av.Scalar(f"/{service}")))
        if node is None:
            endpoints.note_unknown_node(machine, kind.value, name, arguments)
        else:
            endpoints.declare_endpoint(machine, kind, node, name, type, arguments)
    return av.Instance(_CLASSES["LifecycleServiceClient"], {"truth": av.TRUE})


def _make_action_server(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`SimpleActionServer<T>(node, action_name, callback)`."""
    return create_endpoint(DeclarationKind.ACTION_SERVER, machine, NO_OWNER, arguments)


def _declare_if_not_declared(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`declare_parameter_if_not_declared(node, name, default)`."""
    node, rest = split_node(NO_OWNER, arguments)
    if node is not None and not parameters.is_declared(machine, node, rest.value(0)):
        declare_parameter(machine, node, rest)
    return av.NONE


def _plugin_type(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`get_plugin_type_param(node, plugin)`: the parameter `plugin.plugin`."""
    node, rest = split_node(NO_OWNER, arguments)
    if node is None:
        return av.UNKNOWN
    name = av.concat((rest.value(0), av.Scalar(".plugin")))
    if not parameters.is_declared(machine, node, name):
        parameters.declare_node_parameter(machine, node, name, None)
    return parameters.read_node_parameter(machine, node, name)


_NODE_METHODS: dict[str, Callable[..., av.Value]] = {
    **LIFECYCLE_NODE.methods,
    "createBond": _create_bond,
    "add_parameter": declare_parameter,
    "declare_or_get_parameter": _declare_or_get,
    "create_action_server": partial(create_endpoint, DeclarationKind.ACTION_SERVER),
    "create_action_client": partial(create_endpoint, DeclarationKind.ACTION_CLIENT),
}
_MAKERS: Mapping[str, Callable[..., av.Value]] = {
    "ServiceClient": partial(_make_client, DeclarationKind.SERVICE_CLIENT, 1),
    "ServiceServer": partial(_make_client, DeclarationKind.SERVICE, 1),
    "LifecycleServiceClient": _make_transition_client,
    "SimpleActionServer": _make_action_server,
}
_CLASSES: Mapping[str, av.LibraryClass] = {
    name: av.LibraryClass(f"nav2_util::{name}", make, over_source=False)
    for name, make in _MAKERS.items()
}
_NODE = av.LibraryClass(
    "nav2_util::LifecycleNode",
    partial(make_node, lifecycle=True),
    _NODE_METHODS,
    LIFECYCLE_NODE.virtual_callbacks,
    over_source=False,
)
NAV2_CLASSES: Mapping[str, av.LibraryClass] = {
    f"{namespace}::{name}": cls
    for namespace in _NAMESPACES
    for name, cls in {**_CLASSES, "LifecycleNode": _NODE}.items()
}
NAV2_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    f"{namespace}::{name}": call
    for namespace in _NAMESPACES
    for name, call in {
        "declare_parameter_if_not_declared": _declare_if_not_declared,
        "get_plugin_type_param": _plugin_type,
    }.items()
}
