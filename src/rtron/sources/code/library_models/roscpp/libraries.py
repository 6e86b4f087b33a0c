"""ROS's C++ libraries that publish, subscribe and serve for a node: actionlib, tf and others."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    escape_all,
    in_handle,
    message_of,
    take_callbacks,
    texts,
)
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import remapped, resolve
from rtron.sources.code.library_models.roscpp.node_handle import (
    ENDPOINT,
    given_handle,
    handle_among,
    private_handle,
)
from rtron.sources.declaration import DeclarationKind

_UNKNOWN = Hole("?")
_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _transforms(
    kind: DeclarationKind, machine: Machine, arguments: Arguments, *, static: bool = False
) -> Value:
    endpoints.transforms(machine, kind, arguments, static=static)
    return Instance(ENDPOINT)


def _action_server(machine: Machine, arguments: Arguments) -> Value:
    """`SimpleActionServer<T>([handle,] name, …)`."""
    return _action(DeclarationKind.ACTION_SERVER, machine, arguments)


def _action_client(machine: Machine, arguments: Arguments) -> Value:
    """`SimpleActionClient<T>([handle,] name, …)`."""
    return _action(DeclarationKind.ACTION_CLIENT, machine, arguments)


def _action(kind: DeclarationKind, machine: Machine, arguments: Arguments) -> Value:
    names = texts(arguments)
    if names:
        name = in_handle(machine, handle_among(machine, arguments), names[0])
        type = message_of(machine, arguments.types[0] if arguments.types else None, arguments)
        endpoints.declare(machine, kind, name, type, arguments)
    escape_all(machine, arguments)
    return Instance(_ACTION)


def _reconfigure(machine: Machine, arguments: Arguments) -> Value:
    """`dynamic_reconfigure::Server<T>([mutex,] handle)`; the node's private names by default."""
    owner = given_handle(arguments) or private_handle(machine)
    endpoints.dynamic_reconfigure(machine, owner.fields["namespace"], arguments)
    return Instance(_RECONFIGURE)


def _diagnostics(machine: Machine, arguments: Arguments) -> Value:
    endpoints.diagnostics(machine, arguments)
    return Instance(_UPDATER)


def _bond(machine: Machine, arguments: Arguments) -> Value:
    names = texts(arguments)
    endpoints.bond(machine, resolve(machine, names[0] if names else _UNKNOWN), arguments)
    return Instance(ENDPOINT)


def _realtime_publisher(machine: Machine, arguments: Arguments) -> Value:
    """`realtime_tools::RealtimePublisher<T>(handle, topic, queue, latched)`."""
    topic = in_handle(machine, handle_among(machine, arguments), arguments.get(1))
    type = message_of(machine, arguments.types[0] if arguments.types else None, arguments)
    endpoints.declare(machine, _PUBLISH, topic, type, arguments)
    return Instance(ENDPOINT, {"name": remapped(machine, topic)})


def _marker_server(machine: Machine, arguments: Arguments) -> Value:
    """`InteractiveMarkerServer(topic_ns)` (ROS wiki: interactive_markers)."""
    base = resolve(machine, arguments.get(0) or _UNKNOWN)
    for kind, name, type in (
        (_PUBLISH, "update", "visualization_msgs/InteractiveMarkerUpdate"),
        (_PUBLISH, "update_full", "visualization_msgs/InteractiveMarkerInit"),
        (_SUBSCRIBE, "feedback", "visualization_msgs/InteractiveMarkerFeedback"),
    ):
        endpoints.declare(
            machine, kind, endpoints.below(base, name), type, arguments, implicit=True
        )
    return Instance(ENDPOINT)


def _shape_shifter(machine: Machine, _: Value, arguments: Arguments) -> Value:
    """`ShapeShifter::advertise(handle, topic, queue)`: any message type."""
    topic = in_handle(machine, handle_among(machine, arguments), arguments.get(1))
    endpoints.declare(machine, _PUBLISH, topic, "*", arguments)
    return Instance(ENDPOINT, {"name": remapped(machine, topic)})


def _controller_manager(machine: Machine, arguments: Arguments) -> Value:
    """`ControllerManager(robot, handle)` (ROS wiki: controller_manager)."""
    base = in_handle(machine, handle_among(machine, arguments), Known("controller_manager"))
    for name, type in _MANAGER_SERVICES.items():
        kind, service = DeclarationKind.SERVICE, endpoints.below(base, name)
        endpoints.declare(machine, kind, service, f"controller_manager_msgs/{type}", arguments)
    return Instance(ENDPOINT)


_MANAGER_SERVICES = {
    "list_controllers": "ListControllers",
    "list_controller_types": "ListControllerTypes",
    "load_controller": "LoadController",
    "unload_controller": "UnloadController",
    "switch_controller": "SwitchController",
    "reload_controller_libraries": "ReloadControllerLibraries",
}
_ACTION = NativeClass(
    "actionlib",
    methods=dict.fromkeys(
        ("registerGoalCallback", "registerPreemptCallback", "sendGoal", "registerCancelCallback"),
        take_callbacks,
    ),
)
_RECONFIGURE = NativeClass(
    "dynamic_reconfigure::Server", _reconfigure, {"setCallback": take_callbacks}
)
_UPDATER = NativeClass("diagnostic_updater::Updater", _diagnostics, {"add": take_callbacks})
_SHAPE_SHIFTER = NativeClass("topic_tools::ShapeShifter", methods={"advertise": _shape_shifter})
_RECEIVE = partial(_transforms, _SUBSCRIBE)
_SEND = partial(_transforms, _PUBLISH)
_SEND_STATIC = partial(_transforms, _PUBLISH, static=True)

_MADE: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(("tf::TransformListener", "tf2_ros::TransformListener"), _RECEIVE),
    **dict.fromkeys(("tf::TransformBroadcaster", "tf2_ros::TransformBroadcaster"), _SEND),
    "tf2_ros::StaticTransformBroadcaster": _SEND_STATIC,
    "actionlib::SimpleActionServer": _action_server,
    "actionlib::ActionServer": _action_server,
    "actionlib::SimpleActionClient": _action_client,
    "actionlib::ActionClient": _action_client,
    "bond::Bond": _bond,
    "controller_manager::ControllerManager": _controller_manager,
    "realtime_tools::RealtimePublisher": _realtime_publisher,
    "interactive_markers::InteractiveMarkerServer": _marker_server,
}

SERVER_CLASSES = {
    **{name: NativeClass(name, make) for name, make in _MADE.items()},
    **{native.name: native for native in (_RECONFIGURE, _UPDATER, _SHAPE_SHIFTER)},
}
