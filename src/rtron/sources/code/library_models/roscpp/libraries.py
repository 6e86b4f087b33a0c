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


def _make(library: str, machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make what declares something by names of its own."""
    endpoints.declare_library(machine, library, arguments)
    return av.Instance(BROADCASTERS.get(library, _UPDATER if library == _DIAGNOSTICS else ENDPOINT))


def _make_below(library: str, machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make what declares something below the first name that it is given."""
    names = name_arguments(arguments)
    base = resolve_name(machine, names[0] if names else av.UNKNOWN)
    endpoints.declare_library(machine, library, arguments, base)
    return av.Instance(ENDPOINT)


def _make_in_handle(
    library: str, below: str, machine: AbstractMachine, arguments: Arguments
) -> av.Value:
    """Make what declares something in a handle that it is given, or the node's own."""
    owner = handle_argument_or_default(machine, arguments)
    base = resolve_in_handle(machine, owner, av.Scalar(below))
    endpoints.declare_library(machine, library, arguments, base)
    return av.Instance(ENDPOINT)


def _make_action(kind: DeclarationKind, machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`SimpleActionServer<T>([handle,] name, …)`, `SimpleActionClient<T>([handle,] name, …)`."""
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
    endpoints.declare_library(machine, "dynamic_reconfigure", arguments, owner.fields["namespace"])
    return av.Instance(_RECONFIGURE)


def _realtime_publisher(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`realtime_tools::RealtimePublisher<T>(handle, topic, queue, latched)`."""
    topic = resolve_in_handle(
        machine, handle_argument_or_default(machine, arguments), arguments.get(1)
    )
    type = message_type_of(machine, arguments.types[0] if arguments.types else None, arguments)
    endpoints.declare_endpoint(machine, _PUBLISH, topic, type, arguments)
    return av.Instance(ENDPOINT, {"name": remap_name(machine, topic)})


def _shape_shifter(machine: AbstractMachine, _: av.Value, arguments: Arguments) -> av.Value:
    """`ShapeShifter::advertise(handle, topic, queue)`: any message type."""
    topic = resolve_in_handle(
        machine, handle_argument_or_default(machine, arguments), arguments.get(1)
    )
    endpoints.declare_endpoint(machine, _PUBLISH, topic, "*", arguments)
    return av.Instance(ENDPOINT, {"name": remap_name(machine, topic)})


def _move_group_options(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`MoveGroupInterface::Options(group, description, handle)`."""
    return av.Instance(ENDPOINT, dict(handle_argument_or_default(machine, arguments).fields))


_PLANNING = "moveit::planning_interface"
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
_DIAGNOSTICS = "diagnostic_updater"
_UPDATER = av.LibraryClass(
    "diagnostic_updater::Updater", partial(_make, _DIAGNOSTICS), {"add": register_callbacks}
)
_SHAPE_SHIFTER = av.LibraryClass("topic_tools::ShapeShifter", methods={"advertise": _shape_shifter})

_CONSTRUCTORS: Mapping[str, Callable[..., av.Value]] = {
    **{
        f"{space}::{name}": partial(_make, name)
        for space in ("tf", "tf2_ros")
        for name in ("TransformListener", *BROADCASTERS)
    },
    **{
        f"actionlib::{prefix}Action{side}": partial(_make_action, kind)
        for prefix in ("Simple", "")
        for side, kind in (
            ("Server", DeclarationKind.ACTION_SERVER),
            ("Client", DeclarationKind.ACTION_CLIENT),
        )
    },
    "bond::Bond": partial(_make_below, "bond"),
    "controller_manager::ControllerManager": partial(
        _make_in_handle, "controller_manager", "controller_manager"
    ),
    "realtime_tools::RealtimePublisher": _realtime_publisher,
    f"{_PLANNING}::MoveGroupInterface::Options": _move_group_options,
    "interactive_markers::InteractiveMarkerServer": partial(_make_below, "interactive_markers"),
    **dict.fromkeys(
        ("camera_info_manager::CameraInfoManager", "CameraInfoManager"),
        partial(_make_in_handle, "camera_info_manager", ""),
    ),
    **{
        f"{_PLANNING}::{name}": partial(_make_in_handle, "move_group", "")
        for name in ("MoveGroupInterface", "MoveGroup")
    },
}

SERVER_CLASSES = {
    **{name: av.LibraryClass(name, make) for name, make in _CONSTRUCTORS.items()},
    **{cls.name: cls for cls in (_RECONFIGURE, _UPDATER, _SHAPE_SHIFTER)},
}


def _filter_subscriber(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`message_filters::Subscriber<T>(handle, topic, queue)`, or later by `subscribe`."""
    made = av.Instance(_FILTER_SUBSCRIBER, {}, arguments.types)
    if len(arguments.values) > 1:
        _subscribe(machine, made, arguments)
    return made


def _subscribe(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
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
    {"subscribe": _subscribe, "registerCallback": register_callbacks},
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
