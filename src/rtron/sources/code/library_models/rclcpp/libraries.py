"""C++ libraries of ROS 2 that publish, subscribe and serve for a node."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common import cpp_arguments
from rtron.sources.code.library_models.common.move_group import move_group_endpoints
from rtron.sources.code.library_models.common.transforms import BROADCASTERS
from rtron.sources.code.library_models.common.trivial_functions import (
    returning_field,
    returning_unknown,
)
from rtron.sources.code.library_models.rclcpp.endpoints import split_node
from rtron.sources.code.library_models.rclcpp.node import controller_options, make_node
from rtron.sources.code.library_models.rclcpp.parameters import declare_parameter
from rtron.sources.code.library_models.ros2_common import endpoints, libraries
from rtron.sources.code.library_models.ros2_common.nodes import first_node
from rtron.sources.code.library_models.ros2_common.parameters import note_parameter_callbacks
from rtron.sources.code.library_models.ros2_common.qos import (
    QOS_PROFILES,
    is_qos,
    read_qos,
)
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import QoS

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_NO_OWNER = av.Scalar(None)


def _name_arguments(arguments: Arguments) -> list[av.Value]:
    """Return the arguments that are, or may be, texts."""
    return [
        value
        for value in arguments.values
        if any(av.is_text(o) or isinstance(o, av.Unknown) for o in av.options(value))
    ]


def _construct(
    name: str,
    declare: Callable[[AbstractMachine, Arguments], None],
    machine: AbstractMachine,
    arguments: Arguments,
) -> av.Value:
    declare(machine, arguments)
    return av.Instance(LIBRARY_CLASSES[name], {"truth": av.TRUE})


def declare_bond(machine: AbstractMachine, arguments: Arguments) -> None:
    """`bond::Bond(topic, id, node)` publishes and subscribes (bondcpp: bond.cpp)."""
    node, name, type = first_node(arguments.values), arguments.get(0), "bond/msg/Status"
    if node is not None:
        for kind, depth in ((_PUBLISH, 5), (_SUBSCRIBE, 100)):
            endpoints.declare_endpoint(
                machine, kind, node, name, type, arguments, qos=QoS(depth=depth), implicit=True
            )


def _filter_subscriber(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`message_filters::Subscriber<T>(node, topic, qos)`, or later by `subscribe`."""
    made = av.Instance(_FILTER, {"truth": av.TRUE}, arguments.types)
    if arguments.values:
        _subscribe(machine, made, arguments)
    return made


def _subscribe(machine: AbstractMachine, filter_: av.Instance, arguments: Arguments) -> av.Value:
    node, rest = split_node(_NO_OWNER, arguments)
    if not rest.values:
        return filter_
    if node is None:
        endpoints.note_unknown_node(machine, "Subscriber", rest.get(0), rest)
        return filter_
    type = cpp_arguments.message_type_of(
        machine, filter_.types[0] if filter_.types else None, arguments
    )
    found = next((value for value in rest.values[1:] if is_qos(value)), None)
    qos = read_qos(found) if found is not None else QOS_PROFILES["default"]
    endpoints.declare_endpoint(machine, _SUBSCRIBE, node, rest.get(0), type, rest, qos=qos)
    return filter_


def _declare_marker_server(machine: AbstractMachine, arguments: Arguments) -> None:
    """`InteractiveMarkerServer(topic_namespace, node)`."""
    space = next(iter(_name_arguments(arguments)), av.Unknown("topic_namespace"))
    libraries.declare_below(libraries.MARKER_ENDPOINTS, machine, space, arguments)


def _declare_parameters_client(machine: AbstractMachine, arguments: Arguments) -> None:
    """`AsyncParametersClient(node, remote)` calls the parameter services of a node, or its own."""
    remote = split_node(_NO_OWNER, arguments)[1].get(0)
    remote = av.Scalar("~") if remote is None or remote == av.Scalar("") else remote
    libraries.declare_below(libraries.PARAMETER_CLIENTS, machine, remote, arguments)


def _move_group_options(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`MoveGroupInterface::Options(group, description, namespace)`."""
    return av.Instance(_MOVE_GROUP_OPTIONS, {"namespace": arguments.get(2) or av.Scalar("")})


def _declare_move_group_client(machine: AbstractMachine, arguments: Arguments) -> None:
    """`MoveGroupInterface(node, group, …)`, or with options that may have a namespace."""
    node, rest = split_node(_NO_OWNER, arguments)
    given = rest.value(0)
    is_options = isinstance(given, av.Instance) and given.type is _MOVE_GROUP_OPTIONS
    space = given.fields["namespace"] if is_options else av.Scalar("")  # type: ignore[union-attr]
    for kind, name, type, implicit in move_group_endpoints(2):
        below = (space, av.Scalar("/")) if space != av.Scalar("") else ()
        full = av.concat((*below, av.Scalar(name)))
        if node is None:
            endpoints.note_unknown_node(machine, kind.value, full, arguments)
        else:
            endpoints.declare_endpoint(
                machine, kind, node, full, type, arguments, implicit=implicit
            )


def _register_parameter_callback(
    machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    """`add_parameter_callback(name, callback)` and the like."""
    note_parameter_callbacks(machine, arguments)
    return cpp_arguments.register_callbacks(machine, owner, arguments)


_METHODS: Mapping[str, Callable[..., av.Value]] = {
    **dict.fromkeys(("add", "registerCallback"), cpp_arguments.register_callbacks),
    **dict.fromkeys(
        ("add_parameter_callback", "add_parameter_event_callback"), _register_parameter_callback
    ),
}


def _methods(name: str) -> dict[str, Callable[..., av.Value]]:
    broadcaster = BROADCASTERS.get(name.removeprefix("tf2_ros::"))
    return {**_METHODS, **(broadcaster.methods if broadcaster else {})}


_FILTER = av.LibraryClass(
    "message_filters::Subscriber",
    _filter_subscriber,
    {"subscribe": _subscribe, "registerCallback": cpp_arguments.register_callbacks},
)
_PLANNING = "moveit::planning_interface"
_MOVE_GROUP_OPTIONS = av.LibraryClass(
    f"{_PLANNING}::MoveGroupInterface::Options", _move_group_options
)
_NAMESPACES = {
    **dict.fromkeys(("TransformListener", "TransformBroadcaster"), "tf2_ros"),
    **dict.fromkeys(("StaticTransformBroadcaster", "Buffer"), "tf2_ros"),
    "Updater": "diagnostic_updater",
    "CameraInfoManager": "camera_info_manager",
    "ParameterEventHandler": "rclcpp",
}
_DECLARATIONS: Mapping[str, Callable[[AbstractMachine, Arguments], None]] = {
    **{
        f"{_NAMESPACES[name]}::{name}": declare
        for name, declare in libraries.LIBRARY_DECLARATIONS.items()
    },
    "bond::Bond": declare_bond,
    "interactive_markers::InteractiveMarkerServer": _declare_marker_server,
    f"{_PLANNING}::MoveGroupInterface": _declare_move_group_client,
    **dict.fromkeys(
        ("rclcpp::AsyncParametersClient", "rclcpp::SyncParametersClient"),
        _declare_parameters_client,
    ),
    **dict.fromkeys(
        (
            *("message_filters::Synchronizer", "message_filters::TimeSynchronizer"),
            *("message_filters::Cache", "message_filters::Chain", "tf2_ros::MessageFilter"),
        ),
        cpp_arguments.escape_functions,
    ),
}
LIBRARY_CLASSES: Mapping[str, av.LibraryClass] = {
    _FILTER.name: _FILTER,
    _MOVE_GROUP_OPTIONS.name: _MOVE_GROUP_OPTIONS,
    **{
        name: av.LibraryClass(name, partial(_construct, name, declare), _methods(name))
        for name, declare in _DECLARATIONS.items()
    },
}

_NODE = "controller.node"
_CONTROLLER_CALLBACKS = ("on_init", "on_configure", "on_activate")
_BASES = ("ControllerInterfaceBase", "ControllerInterface", "ChainableControllerInterface")


def _make_controller(name: str, machine: AbstractMachine, arguments: Arguments) -> av.Instance:
    """Make a controller's node, which its spawner names; it has no services of its lifecycle."""
    words = (
        av.Scalar("controller"),
        av.Scalar(""),
        controller_options(machine, arguments),
        av.FALSE,
    )
    given = arguments.with_values(*words)
    node = make_node(machine, given, lifecycle=True)
    return av.Instance(CONTROLLER_CLASSES[name], {_NODE: node})


def _auto_declare(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`auto_declare<T>(name, default)`."""
    return declare_parameter(machine, owner.fields.get(_NODE, av.Unknown("node")), arguments)


CONTROLLER_CLASSES: Mapping[str, av.LibraryClass] = {
    name: av.LibraryClass(
        name,
        partial(_make_controller, name),
        {
            "get_node": returning_field(_NODE, av.Unknown("get_node()")),
            "auto_declare": _auto_declare,
            **dict.fromkeys(_CONTROLLER_CALLBACKS, returning_unknown("CallbackReturn::SUCCESS")),
        },
        virtual_callbacks=_CONTROLLER_CALLBACKS,
    )
    for name in (f"controller_interface::{base}" for base in _BASES)
}
