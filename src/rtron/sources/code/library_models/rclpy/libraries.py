"""Python libraries of ROS 2 that publish, subscribe and serve for a node."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    Value,
    concat,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclpy.node import ENDPOINT, declare, escape_all
from rtron.sources.code.library_models.ros2_common import endpoints, libraries
from rtron.sources.code.library_models.ros2_common.libraries import library_node
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _transforms(
    kind: DeclarationKind,
    machine: Machine,
    _: object,
    arguments: Arguments,
    *,
    static: bool = False,
) -> Value:
    libraries.transforms(kind, machine, arguments, static=static)
    return Instance(ENDPOINT)


def _buffer(machine: Machine, _: object, arguments: Arguments) -> Value:
    libraries.buffer(machine, arguments)
    return Instance(ENDPOINT)


def _with_node(kind: DeclarationKind, machine: Machine, _: object, arguments: Arguments) -> Value:
    """`ActionServer(node, type, name, …)`, `message_filters.Subscriber(node, type, topic)`."""
    return declare(kind, machine, arguments.get(0, "node") or Hole("node"), arguments, 1)


def _wait_for_message(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`wait_for_message(type, node, topic)`."""
    values = (arguments.get(0, "msg_type"), arguments.get(2, "topic"))
    given = Arguments(
        values=tuple(value or Hole("?") for value in values),
        line=arguments.line,
        frame=arguments.frame,
    )
    declare(_SUBSCRIBE, machine, arguments.get(1, "node") or Hole("node"), given, 0)
    return Hole("message")


def _diagnostics(machine: Machine, _: object, arguments: Arguments) -> Value:
    libraries.diagnostics(machine, arguments)
    return Instance(ENDPOINT)


def _parameters_client(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`AsyncParameterClient(node, remote)` calls the parameter services of another node."""
    node, remote = library_node(arguments), arguments.get(1, "remote_node_name") or Hole("remote")
    for name, type in endpoints.PARAMETER_SERVICES.items() if node is not None else ():
        kind, full = DeclarationKind.SERVICE_CLIENT, concat((remote, Known(f"/{name}")))
        endpoints.declare(machine, kind, node, full, type, arguments, implicit=True)  # type: ignore[arg-type]
    return Instance(ENDPOINT)


def _markers(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`InteractiveMarkerServer(node, namespace)`."""
    node, space = library_node(arguments), arguments.get(1, "namespace") or Hole("namespace")
    for kind, name, type in _MARKERS if node is not None else ():
        full = concat((space, Known(f"/{name}")))
        endpoints.declare(machine, kind, node, full, type, arguments, implicit=True)  # type: ignore[arg-type]
    return Instance(ENDPOINT)


def _callbacks(machine: Machine, _: object, arguments: Arguments) -> Value:
    escape_all(machine, arguments)
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
_LISTEN, _SEND = partial(_transforms, _SUBSCRIBE), partial(_transforms, _PUBLISH)
_SEND_STATIC = partial(_transforms, _PUBLISH, static=True)
_SERVE = partial(_with_node, DeclarationKind.ACTION_SERVER)
_ASK = partial(_with_node, DeclarationKind.ACTION_CLIENT)
LIBRARY_CALLS: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(("rclpy.action.ActionServer", "rclpy.action.server.ActionServer"), _SERVE),
    **dict.fromkeys(("rclpy.action.ActionClient", "rclpy.action.client.ActionClient"), _ASK),
    "rclpy.wait_for_message.wait_for_message": _wait_for_message,
    "rclpy.parameter_client.AsyncParameterClient": _parameters_client,
    "message_filters.Subscriber": partial(_with_node, _SUBSCRIBE),
    **dict.fromkeys(
        (
            *("message_filters.TimeSynchronizer", "message_filters.Cache"),
            "message_filters.ApproximateTimeSynchronizer",
        ),
        _callbacks,
    ),
    **dict.fromkeys(
        ("tf2_ros.TransformListener", "tf2_ros.transform_listener.TransformListener"), _LISTEN
    ),
    **dict.fromkeys(
        ("tf2_ros.TransformBroadcaster", "tf2_ros.transform_broadcaster.TransformBroadcaster"),
        _SEND,
    ),
    **dict.fromkeys(
        (
            "tf2_ros.StaticTransformBroadcaster",
            "tf2_ros.static_transform_broadcaster.StaticTransformBroadcaster",
        ),
        _SEND_STATIC,
    ),
    **dict.fromkeys(("tf2_ros.Buffer", "tf2_ros.buffer.Buffer"), _buffer),
    "diagnostic_updater.Updater": _diagnostics,
    "interactive_markers.InteractiveMarkerServer": _markers,
    "interactive_markers.interactive_marker_server.InteractiveMarkerServer": _markers,
}
