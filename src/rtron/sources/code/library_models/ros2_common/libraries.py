"""Libraries of ROS 2 that join a node, in C++ and Python alike: tf2_ros, diagnostic_updater."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import NamedTuple

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import nodes
from rtron.sources.code.library_models.ros2_common.endpoints import (
    PARAMETER_SERVICES,
    declare_endpoint,
    note_unknown_node,
)
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Durability, QoS


class ImplicitEndpoint(NamedTuple):
    """An endpoint that a library makes for a node."""

    kind: DeclarationKind
    name: str
    type: str
    qos: QoS | None = None


def node_argument(arguments: Arguments) -> av.Instance | None:
    """Return the node that is among what a library gets."""
    return nodes.first_node(arguments.all_values)


def make_internal_node(machine: AbstractMachine, prefix: str, at: Arguments) -> av.Instance:
    """Return a node that a library makes for itself; its name ends in what only the run knows.

    Its own arguments name it (tf2_ros: TransformListener); the rest of the process's count for it.
    """
    name = av.PartialText((f"__node:={prefix}", av.Unknown("id")))
    words = nodes.NodeArguments(
        name=av.Unknown("id"), arguments=av.list_of((av.Scalar("-r"), name))
    )
    node = av.Instance(av.LibraryClass("node"), {nodes.NAME_FIELD: nodes.full_name(machine, words)})
    nodes.record_node(machine, nodes.node_name(node), words, at)
    return node


def declare_below(
    found: Iterable[ImplicitEndpoint], machine: AbstractMachine, base: av.Value, at: Arguments
) -> None:
    """Record what a library declares below a name, for the node among its arguments."""
    node = node_argument(at)
    if node is None:
        return
    for kind, name, type, qos in found:
        full = av.concat((base, av.Scalar(f"/{name}")))
        declare_endpoint(machine, kind, node, full, type, at, qos=qos, implicit=True)


def _declare(
    found: Iterable[ImplicitEndpoint],
    machine: AbstractMachine,
    at: Arguments,
    node: av.Instance | None = None,
    missing: str = "",
) -> None:
    """Record what a library declares for a node; that there is none is noted under `missing`."""
    node = node or node_argument(at)
    if node is None:
        if missing:
            note_unknown_node(machine, missing, None, at)
        return
    for kind, name, type, qos in found:
        declare_endpoint(machine, kind, node, av.Scalar(name), type, at, qos=qos, implicit=True)


def _declare_listener(machine: AbstractMachine, at: Arguments) -> None:
    """Record `TransformListener(buffer[, node])`."""
    node = node_argument(at) or make_internal_node(machine, "transform_listener_impl_", at)
    _declare(_LISTENER, machine, at, node)


_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_SERVICE, _TF = DeclarationKind.SERVICE, "tf2_msgs/msg/TFMessage"
_STATIC_QOS = QoS(depth=1, durability=Durability.TRANSIENT_LOCAL)
_BROADCASTER = ImplicitEndpoint(_PUBLISH, "/tf", _TF, QoS(depth=100))
_STATIC_BROADCASTER = ImplicitEndpoint(_PUBLISH, "/tf_static", _TF, _STATIC_QOS)
_LISTENER = tuple(one._replace(kind=_SUBSCRIBE) for one in (_BROADCASTER, _STATIC_BROADCASTER))
_DIAGNOSTICS = ImplicitEndpoint(
    _PUBLISH, "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", QoS(depth=1)
)
_BUFFER = ImplicitEndpoint(_SERVICE, "tf2_frames", "tf2_msgs/srv/FrameGraph")
_CALIBRATION = ImplicitEndpoint(_SERVICE, "~/set_camera_info", "sensor_msgs/srv/SetCameraInfo")
_EVENTS = ImplicitEndpoint(_SUBSCRIBE, "/parameter_events", "rcl_interfaces/msg/ParameterEvent")
LIBRARY_DECLARATIONS: Mapping[str, Callable[[AbstractMachine, Arguments], None]] = {
    "TransformListener": _declare_listener,
    "TransformBroadcaster": partial(_declare, [_BROADCASTER], missing="TransformBroadcaster"),
    "StaticTransformBroadcaster": partial(
        _declare, [_STATIC_BROADCASTER], missing="TransformBroadcaster"
    ),
    "Buffer": partial(_declare, [_BUFFER]),
    "Updater": partial(_declare, [_DIAGNOSTICS]),
    "CameraInfoManager": partial(_declare, [_CALIBRATION]),
    "ParameterEventHandler": partial(_declare, [_EVENTS]),
}
"""What making an object of a class declares (docs.ros.org: tf2_ros, diagnostic_updater, rclcpp)."""
MARKER_ENDPOINTS = (
    ImplicitEndpoint(_PUBLISH, "update", "visualization_msgs/msg/InteractiveMarkerUpdate"),
    ImplicitEndpoint(_SUBSCRIBE, "feedback", "visualization_msgs/msg/InteractiveMarkerFeedback"),
    ImplicitEndpoint(
        _SERVICE, "get_interactive_markers", "visualization_msgs/srv/GetInteractiveMarkers"
    ),
)
PARAMETER_CLIENTS = tuple(
    ImplicitEndpoint(DeclarationKind.SERVICE_CLIENT, name, type)
    for name, type in PARAMETER_SERVICES.items()
)
