"""ROS's C++ libraries that publish, subscribe and serve for a node: actionlib, tf and others."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    escape_functions,
    message_type_of,
    name_arguments,
    register_callbacks,
    resolve_in_handle,
)
from rtron.sources.code.library_models.common.transforms import BROADCASTERS
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import remap_name, resolve_name
from rtron.sources.code.library_models.roscpp.node_handle import (
    ENDPOINT,
    handle_argument,
    handle_argument_or_default,
    private_handle,
)
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _make_listener(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    endpoints.declare_transforms(machine, _SUBSCRIBE, arguments, static=False)
    return av.Instance(ENDPOINT)


def _make_broadcaster(name: str, machine: AbstractMachine, arguments: Arguments) -> av.Value:
    static = name.startswith("Static")
    endpoints.declare_transforms(machine, _PUBLISH, arguments, static=static)
    return av.Instance(BROADCASTERS[name])


def _action_server(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`SimpleActionServer<T>([handle,] name, …)`."""
    return _make_action(DeclarationKind.ACTION_SERVER, machine, arguments)


def _action_client(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`SimpleActionClient<T>([handle,] name, …)`."""
    return _make_action(DeclarationKind.ACTION_CLIENT, machine, arguments)


def _make_action(kind: DeclarationKind, machine: AbstractMachine, arguments: Arguments) -> av.Value:
    names = name_arguments(arguments)
    if names:
        name = resolve_in_handle(machine, handle_argument_or_default(machine, arguments), names[0])
        type = message_type_of(machine, arguments.types[0] if arguments.types else None, arguments)
        endpoints.declare_endpoint(machine, kind, name, type, arguments)
    escape_functions(machine, arguments)
    return av.Instance(_ACTION)


def _reconfigure(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`dynamic_reconfigure::Server<T>([mutex,] handle)`; the node's private names by default."""
    owner = handle_argument(arguments) or private_handle(machine)
    endpoints.declare_dynamic_reconfigure(machine, owner.fields["namespace"], arguments)
    return av.Instance(_RECONFIGURE)


def _diagnostics(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    endpoints.declare_diagnostics(machine, arguments)
    return av.Instance(_UPDATER)


def _make_bond(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    names = name_arguments(arguments)
    endpoints.declare_bond(
        machine, resolve_name(machine, names[0] if names else av.UNKNOWN), arguments
    )
    return av.Instance(ENDPOINT)


def _realtime_publisher(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`realtime_tools::RealtimePublisher<T>(handle, topic, queue, latched)`."""
    topic = resolve_in_handle(
        machine, handle_argument_or_default(machine, arguments), arguments.get(1)
    )
    type = message_type_of(machine, arguments.types[0] if arguments.types else None, arguments)
    endpoints.declare_endpoint(machine, _PUBLISH, topic, type, arguments)
    return av.Instance(ENDPOINT, {"name": remap_name(machine, topic)})


def _marker_server(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`InteractiveMarkerServer(topic_ns)` (ROS wiki: interactive_markers)."""
    base = resolve_name(machine, arguments.value(0))
    for kind, name, type in (
        (_PUBLISH, "update", "visualization_msgs/InteractiveMarkerUpdate"),
        (_PUBLISH, "update_full", "visualization_msgs/InteractiveMarkerInit"),
        (_SUBSCRIBE, "feedback", "visualization_msgs/InteractiveMarkerFeedback"),
    ):
        endpoints.declare_endpoint(
            machine, kind, endpoints.name_below(base, name), type, arguments, implicit=True
        )
    return av.Instance(ENDPOINT)


def _shape_shifter(machine: AbstractMachine, _: av.Value, arguments: Arguments) -> av.Value:
    """`ShapeShifter::advertise(handle, topic, queue)`: any message type."""
    topic = resolve_in_handle(
        machine, handle_argument_or_default(machine, arguments), arguments.get(1)
    )
    endpoints.declare_endpoint(machine, _PUBLISH, topic, "*", arguments)
    return av.Instance(ENDPOINT, {"name": remap_name(machine, topic)})


def _controller_manager(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`ControllerManager(robot, handle)` (ROS wiki: controller_manager)."""
    base = resolve_in_handle(
        machine, handle_argument_or_default(machine, arguments), av.Scalar("controller_manager")
    )
    for name, type in _MANAGER_SERVICES.items():
        kind, service = DeclarationKind.SERVICE, endpoints.name_below(base, name)
        endpoints.declare_endpoint(
            machine, kind, service, f"controller_manager_msgs/{type}", arguments
        )
    return av.Instance(ENDPOINT)


def _move_group_client(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`MoveGroupInterface(group, …)`, or with options, which have the namespace of a handle."""
    namespace = handle_argument_or_default(machine, arguments).fields["namespace"]
    endpoints.declare_move_group_client(machine, namespace, arguments)
    return av.Instance(ENDPOINT)


def _move_group_options(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`MoveGroupInterface::Options(group, description, handle)`."""
    return av.Instance(_MOVE_GROUP_OPTIONS, handle_argument_or_default(machine, arguments).fields)


_PLANNING = "moveit::planning_interface"
_MOVE_GROUP_OPTIONS = av.LibraryClass(
    f"{_PLANNING}::MoveGroupInterface::Options", _move_group_options
)
_MANAGER_SERVICES = {
    "list_controllers": "ListControllers",
    "list_controller_types": "ListControllerTypes",
    "load_controller": "LoadController",
    "unload_controller": "UnloadController",
    "switch_controller": "SwitchController",
    "reload_controller_libraries": "ReloadControllerLibraries",
}
_ACTION = av.LibraryClass(
    "actionlib",
    methods=dict.fromkeys(
        ("registerGoalCallback", "registerPreemptCallback", "sendGoal", "registerCancelCallback"),
        register_callbacks,
    ),
)
_RECONFIGURE = av.LibraryClass(
    "dynamic_reconfigure::Server", _reconfigure, {"setCallback": register_callbacks}
)
_UPDATER = av.LibraryClass("diagnostic_updater::Updater", _diagnostics, {"add": register_callbacks})
_SHAPE_SHIFTER = av.LibraryClass("topic_tools::ShapeShifter", methods={"advertise": _shape_shifter})

_CONSTRUCTORS: Mapping[str, Callable[..., av.Value]] = {
    **dict.fromkeys(("tf::TransformListener", "tf2_ros::TransformListener"), _make_listener),
    "tf::TransformBroadcaster": partial(_make_broadcaster, "TransformBroadcaster"),
    **{f"tf2_ros::{name}": partial(_make_broadcaster, name) for name in BROADCASTERS},
    "actionlib::SimpleActionServer": _action_server,
    "actionlib::ActionServer": _action_server,
    "actionlib::SimpleActionClient": _action_client,
    "actionlib::ActionClient": _action_client,
    "bond::Bond": _make_bond,
    "controller_manager::ControllerManager": _controller_manager,
    "realtime_tools::RealtimePublisher": _realtime_publisher,
    "interactive_markers::InteractiveMarkerServer": _marker_server,
    f"{_PLANNING}::MoveGroupInterface": _move_group_client,
    f"{_PLANNING}::MoveGroup": _move_group_client,
}

SERVER_CLASSES = {
    **{name: av.LibraryClass(name, make) for name, make in _CONSTRUCTORS.items()},
    **{cls.name: cls for cls in (_RECONFIGURE, _UPDATER, _SHAPE_SHIFTER, _MOVE_GROUP_OPTIONS)},
}


def _filter_subscriber(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`message_filters::Subscriber<T>(handle, topic, queue)`, or later by `subscribe`."""
    made = av.Instance(_FILTER_SUBSCRIBER, {}, arguments.types)
    if len(arguments.values) > 1:
        _filter_subscribe(machine, made, arguments)
    return made


def _filter_subscribe(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    names = name_arguments(arguments)
    topic = resolve_in_handle(
        machine, handle_argument_or_default(machine, arguments), names[0] if names else None
    )
    type = message_type_of(machine, owner.types[0] if owner.types else None, arguments)
    endpoints.declare_endpoint(machine, DeclarationKind.SUBSCRIBE, topic, type, arguments)
    return owner


_FILTER_SUBSCRIBER = av.LibraryClass(
    "message_filters::Subscriber",
    _filter_subscriber,
    {"subscribe": _filter_subscribe, "registerCallback": register_callbacks},
)
_SYNCHRONIZERS = (
    "message_filters::Synchronizer",
    "message_filters::TimeSynchronizer",
    "tf::MessageFilter",
    "tf2_ros::MessageFilter",
    "message_filters::Cache",
)

FILTER_CLASSES = {
    _FILTER_SUBSCRIBER.name: _FILTER_SUBSCRIBER,
    **{
        name: av.LibraryClass(name, methods={"registerCallback": register_callbacks})
        for name in _SYNCHRONIZERS
    },
}
