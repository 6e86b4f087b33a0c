"""C++ libraries of ROS 2 that publish, subscribe and serve for a node."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    TRUE,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    concat,
    is_text,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    escape_all,
    message_of,
    take_callbacks,
)
from rtron.sources.code.library_models.rclcpp.endpoints import owned
from rtron.sources.code.library_models.ros2_common import endpoints, libraries
from rtron.sources.code.library_models.ros2_common.nodes import (
    node_among,
)
from rtron.sources.code.library_models.ros2_common.parameters import watch_changes
from rtron.sources.code.library_models.ros2_common.qos import PROFILES, is_qos, qos_of
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_NONE = Known(None)


def _names(arguments: Arguments) -> list[Value]:
    """Return the arguments that are, or may be, texts."""
    return [
        value
        for value in arguments.values
        if any(is_text(o) or isinstance(o, Hole) for o in options(value))
    ]


def _transforms(
    kind: DeclarationKind, machine: Machine, arguments: Arguments, *, static: bool = False
) -> Value:
    libraries.transforms(kind, machine, arguments, static=static)
    return Instance(_LIBRARY, {"truth": TRUE})


def _buffer(machine: Machine, arguments: Arguments) -> Value:
    libraries.buffer(machine, arguments)
    return Instance(_LIBRARY, {"truth": TRUE})


def _diagnostics(machine: Machine, arguments: Arguments) -> Value:
    libraries.diagnostics(machine, arguments)
    return Instance(_UPDATER, {"truth": TRUE})


def _bond(machine: Machine, arguments: Arguments) -> Value:
    """`bond::Bond(topic, id, node)` both speaks and hears."""
    node = node_among(arguments.values)
    for kind in (_PUBLISH, _SUBSCRIBE) if node is not None else ():
        name, type = arguments.get(0), "bond/msg/Status"
        endpoints.declare(machine, kind, node, name, type, arguments, implicit=True)  # type: ignore[arg-type]
    return Instance(_LIBRARY, {"truth": TRUE})


def _filter_subscriber(machine: Machine, arguments: Arguments) -> Value:
    """`message_filters::Subscriber<T>(node, topic, qos)`, or later by `subscribe`."""
    made = Instance(_FILTER, {"truth": TRUE}, arguments.types)
    if arguments.values:
        _filter_subscribe(machine, made, arguments)
    return made


def _filter_subscribe(machine: Machine, filter_: Instance, arguments: Arguments) -> Value:
    node, rest = owned(_NONE, arguments)
    if not rest.values:
        return filter_
    if node is None:
        endpoints.unknown_owner(machine, "Subscriber", rest.get(0), rest)
        return filter_
    type = message_of(machine, filter_.types[0] if filter_.types else None, arguments)
    found = next((value for value in rest.values[1:] if is_qos(value)), None)
    qos = qos_of(found) if found is not None else PROFILES["default"]
    endpoints.declare(machine, _SUBSCRIBE, node, rest.get(0), type, rest, qos=qos)
    return filter_


def _marker_server(machine: Machine, arguments: Arguments) -> Value:
    """`InteractiveMarkerServer(topic_namespace, node)`."""
    node = node_among(arguments.values)
    space = next(iter(_names(arguments)), Hole("topic_namespace"))
    if node is not None:
        for kind, name, type in (
            (_PUBLISH, "update", "visualization_msgs/msg/InteractiveMarkerUpdate"),
            (_SUBSCRIBE, "feedback", "visualization_msgs/msg/InteractiveMarkerFeedback"),
            (
                DeclarationKind.SERVICE,
                "get_interactive_markers",
                "visualization_msgs/srv/GetInteractiveMarkers",
            ),
        ):
            full = concat((space, Known(f"/{name}")))
            endpoints.declare(machine, kind, node, full, type, arguments, implicit=True)
    return Instance(_LIBRARY, {"truth": TRUE})


def _camera_info_manager(machine: Machine, arguments: Arguments) -> Value:
    """`CameraInfoManager(node, …)` offers set_camera_info."""
    node = node_among(arguments.values)
    if node is not None:
        kind, name = DeclarationKind.SERVICE, Known("~/set_camera_info")
        type = "sensor_msgs/srv/SetCameraInfo"
        endpoints.declare(machine, kind, node, name, type, arguments, implicit=True)
    return Instance(_LIBRARY, {"truth": TRUE})


def _parameters_client(machine: Machine, arguments: Arguments) -> Value:
    """`AsyncParametersClient(node, remote)` calls the parameter services of a node, or its own."""
    node, rest = owned(_NONE, arguments)
    remote = rest.get(0)
    remote = Known("~") if remote in (None, Known("")) else remote
    for name, type in endpoints.PARAMETER_SERVICES.items() if node else ():
        kind, full = DeclarationKind.SERVICE_CLIENT, concat((remote, Known(f"/{name}")))
        endpoints.declare(machine, kind, node, full, type, arguments, implicit=True)  # type: ignore[arg-type]
    return Instance(_LIBRARY, {"truth": TRUE})


def _event_handler(machine: Machine, arguments: Arguments) -> Value:
    """`rclcpp::ParameterEventHandler(node)`."""
    node = node_among(arguments.values)
    if node is not None:
        name, type = Known("/parameter_events"), "rcl_interfaces/msg/ParameterEvent"
        endpoints.declare(machine, _SUBSCRIBE, node, name, type, arguments, implicit=True)
    return Instance(_EVENT_HANDLER, {"truth": TRUE})


def _take_changes(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`add_parameter_callback(name, callback)` and its kin."""
    watch_changes(machine, arguments)
    return take_callbacks(machine, owner, arguments)


def _callbacks(machine: Machine, arguments: Arguments) -> Value:
    escape_all(machine, arguments)
    return Instance(_UPDATER, {"truth": TRUE})


_LIBRARY = NativeClass("library")
_UPDATER = NativeClass(
    "updater",
    methods=dict.fromkeys(("add", "registerCallback"), take_callbacks),
)
_EVENT_HANDLER = NativeClass(
    "rclcpp::ParameterEventHandler",
    methods=dict.fromkeys(
        ("add_parameter_callback", "add_parameter_event_callback"), _take_changes
    ),
)
_FILTER = NativeClass(
    "message_filters::Subscriber",
    _filter_subscriber,
    {"subscribe": _filter_subscribe, "registerCallback": take_callbacks},
)
_MADE: Mapping[str, Callable[..., Value]] = {
    "tf2_ros::TransformListener": partial(_transforms, _SUBSCRIBE),
    "tf2_ros::TransformBroadcaster": partial(_transforms, _PUBLISH),
    "tf2_ros::StaticTransformBroadcaster": partial(_transforms, _PUBLISH, static=True),
    "tf2_ros::Buffer": _buffer,
    "diagnostic_updater::Updater": _diagnostics,
    "bond::Bond": _bond,
    "interactive_markers::InteractiveMarkerServer": _marker_server,
    "camera_info_manager::CameraInfoManager": _camera_info_manager,
    **dict.fromkeys(
        ("rclcpp::AsyncParametersClient", "rclcpp::SyncParametersClient"), _parameters_client
    ),
    "rclcpp::ParameterEventHandler": _event_handler,
    **dict.fromkeys(
        (
            *("message_filters::Synchronizer", "message_filters::TimeSynchronizer"),
            *("message_filters::Cache", "message_filters::Chain", "tf2_ros::MessageFilter"),
        ),
        _callbacks,
    ),
}
LIBRARY_CLASSES: Mapping[str, NativeClass] = {
    _FILTER.name: _FILTER,
    **{name: NativeClass(name, make, dict(_UPDATER.methods)) for name, make in _MADE.items()},
}
