"""Python libraries of ROS 2 that publish, subscribe and serve for a node."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    UNKNOWN,
    Instance,
    Scalar,
    Unknown,
    Value,
    concat,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclpy.node import (
    ENDPOINT,
    declare_endpoint,
)
from rtron.sources.code.library_models.ros2_common import endpoints, libraries
from rtron.sources.code.library_models.ros2_common.libraries import node_argument
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _declare_transforms(
    kind: DeclarationKind,
    machine: AbstractMachine,
    _: object,
    arguments: Arguments,
    *,
    static: bool = False,
) -> Value:
    libraries.declare_transforms(kind, machine, arguments, static=static)
    return Instance(ENDPOINT)


def _declare_buffer(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    libraries.declare_buffer(machine, arguments)
    return Instance(ENDPOINT)


def _declare_with_node(
    kind: DeclarationKind, machine: AbstractMachine, _: object, arguments: Arguments
) -> Value:
    """`ActionServer(node, type, name, …)`, `message_filters.Subscriber(node, type, topic)`."""
    return declare_endpoint(
        kind, machine, arguments.get(0, "node") or Unknown("node"), arguments, 1
    )


def _wait_for_message(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`wait_for_message(type, node, topic)`."""
    values = (arguments.get(0, "msg_type"), arguments.get(2, "topic"))
    given = arguments.with_values(*tuple(value or UNKNOWN for value in values))
    declare_endpoint(_SUBSCRIBE, machine, arguments.get(1, "node") or Unknown("node"), given, 0)
    return Unknown("message")


def _declare_diagnostics(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    libraries.declare_diagnostics(machine, arguments)
    return Instance(ENDPOINT)


def _parameters_client(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`AsyncParameterClient(node, remote)` calls the parameter services of another node."""
    node, remote = (
        node_argument(arguments),
        arguments.get(1, "remote_node_name") or Unknown("remote"),
    )
    for name, type in endpoints.PARAMETER_SERVICES.items() if node is not None else ():
        kind, full = DeclarationKind.SERVICE_CLIENT, concat((remote, Scalar(f"/{name}")))
        endpoints.declare_endpoint(machine, kind, node, full, type, arguments, implicit=True)  # type: ignore[arg-type]
    return Instance(ENDPOINT)


def _make_marker_server(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`InteractiveMarkerServer(node, namespace)`."""
    node, space = node_argument(arguments), arguments.get(1, "namespace") or Unknown("namespace")
    for kind, name, type in _MARKERS if node is not None else ():
        full = concat((space, Scalar(f"/{name}")))
        endpoints.declare_endpoint(machine, kind, node, full, type, arguments, implicit=True)  # type: ignore[arg-type]
    return Instance(ENDPOINT)


def _register_callbacks(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    machine.escape_arguments(arguments)
    return Instance(ENDPOINT)


_MARKERS = (
    (_PUBLISH, "update", "visualization_msgs/msg/InteractiveMarkerUpdate"),
    (_SUBSCRIBE, "feedback", "visualization_msgs/msg/InteractiveMarkerFeedback"),
    (
        DeclarationKind.SERVICE,
        "get_interactive_markers",
        "visualization_msgs/srv/GetInteractiveMarkers",
    ),
)
_TRANSFORM_LISTENER, _TRANSFORM_BROADCASTER = (
    partial(_declare_transforms, _SUBSCRIBE),
    partial(_declare_transforms, _PUBLISH),
)
_STATIC_TRANSFORM_BROADCASTER = partial(_declare_transforms, _PUBLISH, static=True)
_ACTION_SERVER = partial(_declare_with_node, DeclarationKind.ACTION_SERVER)
_ACTION_CLIENT = partial(_declare_with_node, DeclarationKind.ACTION_CLIENT)
LIBRARY_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(
        ("rclpy.action.ActionServer", "rclpy.action.server.ActionServer"), _ACTION_SERVER
    ),
    **dict.fromkeys(
        ("rclpy.action.ActionClient", "rclpy.action.client.ActionClient"), _ACTION_CLIENT
    ),
    "rclpy.wait_for_message.wait_for_message": _wait_for_message,
    "rclpy.parameter_client.AsyncParameterClient": _parameters_client,
    "message_filters.Subscriber": partial(_declare_with_node, _SUBSCRIBE),
    **dict.fromkeys(
        (
            *("message_filters.TimeSynchronizer", "message_filters.Cache"),
            "message_filters.ApproximateTimeSynchronizer",
        ),
        _register_callbacks,
    ),
    **dict.fromkeys(
        ("tf2_ros.TransformListener", "tf2_ros.transform_listener.TransformListener"),
        _TRANSFORM_LISTENER,
    ),
    **dict.fromkeys(
        ("tf2_ros.TransformBroadcaster", "tf2_ros.transform_broadcaster.TransformBroadcaster"),
        _TRANSFORM_BROADCASTER,
    ),
    **dict.fromkeys(
        (
            "tf2_ros.StaticTransformBroadcaster",
            "tf2_ros.static_transform_broadcaster.StaticTransformBroadcaster",
        ),
        _STATIC_TRANSFORM_BROADCASTER,
    ),
    **dict.fromkeys(("tf2_ros.Buffer", "tf2_ros.buffer.Buffer"), _declare_buffer),
    "diagnostic_updater.Updater": _declare_diagnostics,
    "interactive_markers.InteractiveMarkerServer": _make_marker_server,
    "interactive_markers.interactive_marker_server.InteractiveMarkerServer": _make_marker_server,
}
