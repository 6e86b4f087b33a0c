"""C++ libraries of ROS 2 that publish, subscribe and serve for a node."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    TRUE,
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
    concat,
    is_text,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    escape_functions,
    message_type_of,
    register_callbacks,
)
from rtron.sources.code.library_models.common.trivial_functions import returning_unknown
from rtron.sources.code.library_models.rclcpp.endpoints import split_node_argument
from rtron.sources.code.library_models.rclcpp.node import controller_options, make_node
from rtron.sources.code.library_models.rclcpp.parameters import declare_parameter
from rtron.sources.code.library_models.ros2_common import endpoints, libraries
from rtron.sources.code.library_models.ros2_common.nodes import (
    first_node,
)
from rtron.sources.code.library_models.ros2_common.parameters import note_parameter_callbacks
from rtron.sources.code.library_models.ros2_common.qos import QOS_PROFILES, is_qos, read_qos
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_NO_OWNER = Scalar(None)


def _name_arguments(arguments: Arguments) -> list[Value]:
    """Return the arguments that are, or may be, texts."""
    return [
        value
        for value in arguments.values
        if any(is_text(o) or isinstance(o, Unknown) for o in options(value))
    ]


def _make_transform_endpoint(
    kind: DeclarationKind, machine: AbstractMachine, arguments: Arguments, *, static: bool = False
) -> Value:
    libraries.declare_transforms(kind, machine, arguments, static=static)
    return Instance(_LIBRARY, {"truth": TRUE})


def _make_buffer(machine: AbstractMachine, arguments: Arguments) -> Value:
    libraries.declare_buffer(machine, arguments)
    return Instance(_LIBRARY, {"truth": TRUE})


def _make_diagnostics(machine: AbstractMachine, arguments: Arguments) -> Value:
    libraries.declare_diagnostics(machine, arguments)
    return Instance(_UPDATER, {"truth": TRUE})


def _make_bond(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`bond::Bond(topic, id, node)` publishes and subscribes."""
    node = first_node(arguments.values)
    for kind in (_PUBLISH, _SUBSCRIBE) if node is not None else ():
        name, type = arguments.get(0), "bond/msg/Status"
        endpoints.declare_endpoint(machine, kind, node, name, type, arguments, implicit=True)  # type: ignore[arg-type]
    return Instance(_LIBRARY, {"truth": TRUE})


def _filter_subscriber(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`message_filters::Subscriber<T>(node, topic, qos)`, or later by `subscribe`."""
    made = Instance(_FILTER, {"truth": TRUE}, arguments.types)
    if arguments.values:
        _filter_subscribe(machine, made, arguments)
    return made


def _filter_subscribe(machine: AbstractMachine, filter_: Instance, arguments: Arguments) -> Value:
    node, rest = split_node_argument(_NO_OWNER, arguments)
    if not rest.values:
        return filter_
    if node is None:
        endpoints.note_unknown_node(machine, "Subscriber", rest.get(0), rest)
        return filter_
    type = message_type_of(machine, filter_.types[0] if filter_.types else None, arguments)
    found = next((value for value in rest.values[1:] if is_qos(value)), None)
    qos = read_qos(found) if found is not None else QOS_PROFILES["default"]
    endpoints.declare_endpoint(machine, _SUBSCRIBE, node, rest.get(0), type, rest, qos=qos)
    return filter_


def _marker_server(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`InteractiveMarkerServer(topic_namespace, node)`."""
    node = first_node(arguments.values)
    space = next(iter(_name_arguments(arguments)), Unknown("topic_namespace"))
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
            full = concat((space, Scalar(f"/{name}")))
            endpoints.declare_endpoint(machine, kind, node, full, type, arguments, implicit=True)
    return Instance(_LIBRARY, {"truth": TRUE})


def _camera_info_manager(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`CameraInfoManager(node, …)` offers set_camera_info."""
    node = first_node(arguments.values)
    if node is not None:
        kind, name = DeclarationKind.SERVICE, Scalar("~/set_camera_info")
        type = "sensor_msgs/srv/SetCameraInfo"
        endpoints.declare_endpoint(machine, kind, node, name, type, arguments, implicit=True)
    return Instance(_LIBRARY, {"truth": TRUE})


def _parameters_client(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`AsyncParametersClient(node, remote)` calls the parameter services of a node, or its own."""
    node, rest = split_node_argument(_NO_OWNER, arguments)
    remote = rest.get(0)
    remote = Scalar("~") if remote in (None, Scalar("")) else remote
    for name, type in endpoints.PARAMETER_SERVICES.items() if node else ():
        kind, full = DeclarationKind.SERVICE_CLIENT, concat((remote, Scalar(f"/{name}")))
        endpoints.declare_endpoint(machine, kind, node, full, type, arguments, implicit=True)  # type: ignore[arg-type]
    return Instance(_LIBRARY, {"truth": TRUE})


def _event_handler(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`rclcpp::ParameterEventHandler(node)`."""
    node = first_node(arguments.values)
    if node is not None:
        name, type = Scalar("/parameter_events"), "rcl_interfaces/msg/ParameterEvent"
        endpoints.declare_endpoint(machine, _SUBSCRIBE, node, name, type, arguments, implicit=True)
    return Instance(_EVENT_HANDLER, {"truth": TRUE})


def _register_parameter_callback(
    machine: AbstractMachine, owner: Value, arguments: Arguments
) -> Value:
    """`add_parameter_callback(name, callback)` and the like."""
    note_parameter_callbacks(machine, arguments)
    return register_callbacks(machine, owner, arguments)


def _make_filter(machine: AbstractMachine, arguments: Arguments) -> Value:
    escape_functions(machine, arguments)
    return Instance(_UPDATER, {"truth": TRUE})


_LIBRARY = LibraryClass("library")
_UPDATER = LibraryClass(
    "updater",
    methods=dict.fromkeys(("add", "registerCallback"), register_callbacks),
)
_EVENT_HANDLER = LibraryClass(
    "rclcpp::ParameterEventHandler",
    methods=dict.fromkeys(
        ("add_parameter_callback", "add_parameter_event_callback"), _register_parameter_callback
    ),
)
_FILTER = LibraryClass(
    "message_filters::Subscriber",
    _filter_subscriber,
    {"subscribe": _filter_subscribe, "registerCallback": register_callbacks},
)
_CONSTRUCTORS: Mapping[str, Callable[..., Value]] = {
    "tf2_ros::TransformListener": partial(_make_transform_endpoint, _SUBSCRIBE),
    "tf2_ros::TransformBroadcaster": partial(_make_transform_endpoint, _PUBLISH),
    "tf2_ros::StaticTransformBroadcaster": partial(_make_transform_endpoint, _PUBLISH, static=True),
    "tf2_ros::Buffer": _make_buffer,
    "diagnostic_updater::Updater": _make_diagnostics,
    "bond::Bond": _make_bond,
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
        _make_filter,
    ),
}
LIBRARY_CLASSES: Mapping[str, LibraryClass] = {
    _FILTER.name: _FILTER,
    **{
        name: LibraryClass(name, make, dict(_UPDATER.methods))
        for name, make in _CONSTRUCTORS.items()
    },
}

_NODE = "controller.node"
_CONTROLLER_CALLBACKS = ("on_init", "on_configure", "on_activate")
_BASES = ("ControllerInterfaceBase", "ControllerInterface", "ChainableControllerInterface")


def _make_controller(name: str, machine: AbstractMachine, arguments: Arguments) -> Instance:
    """Make a controller's node, which its spawner names; it has no services of its lifecycle."""
    words = (Scalar("controller"), Scalar(""), controller_options(machine, arguments), FALSE)
    given = arguments.with_values(*words)
    node = make_node(machine, given, lifecycle=True)
    return Instance(CONTROLLER_CLASSES[name], {_NODE: node})


def _get_node(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get(_NODE, Unknown("get_node()"))


def _auto_declare(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`auto_declare<T>(name, default)`."""
    return declare_parameter(machine, owner.fields.get(_NODE, Unknown("node")), arguments)


CONTROLLER_CLASSES: Mapping[str, LibraryClass] = {
    name: LibraryClass(
        name,
        partial(_make_controller, name),
        {
            "get_node": _get_node,
            "auto_declare": _auto_declare,
            **dict.fromkeys(_CONTROLLER_CALLBACKS, returning_unknown("CallbackReturn::SUCCESS")),
        },
        virtual_callbacks=_CONTROLLER_CALLBACKS,
    )
    for name in (f"controller_interface::{base}" for base in _BASES)
}
