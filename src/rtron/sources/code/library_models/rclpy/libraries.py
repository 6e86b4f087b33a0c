"""Python libraries of ROS 2 that publish, subscribe and serve for a node."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.transforms import BROADCASTERS
from rtron.sources.code.library_models.rclpy.node import ENDPOINT, declare_endpoint
from rtron.sources.code.library_models.ros2_common import libraries
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _construct(
    name: str,
    declare: Callable[[AbstractMachine, Arguments], None],
    machine: AbstractMachine,
    _: object,
    arguments: Arguments,
) -> av.Value:
    declare(machine, arguments)
    return av.Instance(BROADCASTERS.get(name.rpartition(".")[2], ENDPOINT))


def _declare_with_node(
    kind: DeclarationKind, machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Value:
    """`ActionServer(node, type, name, …)`, `message_filters.Subscriber(node, type, topic)`."""
    return declare_endpoint(
        kind, machine, arguments.get(0, "node") or av.Unknown("node"), arguments, 1
    )


def _wait_for_message(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`wait_for_message(type, node, topic)`."""
    values = (arguments.get(0, "msg_type"), arguments.get(2, "topic"))
    given = arguments.with_values(*tuple(value or av.UNKNOWN for value in values))
    declare_endpoint(_SUBSCRIBE, machine, arguments.get(1, "node") or av.Unknown("node"), given, 0)
    return av.Unknown("message")


def _declare_parameters_client(machine: AbstractMachine, arguments: Arguments) -> None:
    """`AsyncParameterClient(node, remote)` calls the parameter services of another node."""
    remote = arguments.get(1, "remote_node_name") or av.Unknown("remote")
    libraries.declare_below(libraries.PARAMETER_CLIENTS, machine, remote, arguments)


def _declare_marker_server(machine: AbstractMachine, arguments: Arguments) -> None:
    """`InteractiveMarkerServer(node, namespace)`."""
    space = arguments.get(1, "namespace") or av.Unknown("namespace")
    libraries.declare_below(libraries.MARKER_ENDPOINTS, machine, space, arguments)


_MODULES = {
    "TransformListener": ("tf2_ros", "tf2_ros.transform_listener"),
    "TransformBroadcaster": ("tf2_ros", "tf2_ros.transform_broadcaster"),
    "StaticTransformBroadcaster": ("tf2_ros", "tf2_ros.static_transform_broadcaster"),
    "Buffer": ("tf2_ros", "tf2_ros.buffer"),
    "Updater": ("diagnostic_updater",),
}
_DECLARATIONS: Mapping[str, Callable[[AbstractMachine, Arguments], None]] = {
    **{
        f"{module}.{name}": libraries.LIBRARY_DECLARATIONS[name]
        for name, modules in _MODULES.items()
        for module in modules
    },
    **{
        f"interactive_markers{module}.InteractiveMarkerServer": _declare_marker_server
        for module in ("", ".interactive_marker_server")
    },
    "rclpy.parameter_client.AsyncParameterClient": _declare_parameters_client,
    **dict.fromkeys(
        (
            *("message_filters.TimeSynchronizer", "message_filters.Cache"),
            "message_filters.ApproximateTimeSynchronizer",
        ),
        AbstractMachine.escape_arguments,
    ),
}
LIBRARY_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    **dict.fromkeys(
        ("rclpy.action.ActionServer", "rclpy.action.server.ActionServer"),
        partial(_declare_with_node, DeclarationKind.ACTION_SERVER),
    ),
    **dict.fromkeys(
        ("rclpy.action.ActionClient", "rclpy.action.client.ActionClient"),
        partial(_declare_with_node, DeclarationKind.ACTION_CLIENT),
    ),
    "rclpy.wait_for_message.wait_for_message": _wait_for_message,
    "message_filters.Subscriber": partial(_declare_with_node, _SUBSCRIBE),
    **{name: partial(_construct, name, declare) for name, declare in _DECLARATIONS.items()},
}
