"""rclpy and the Python libraries of ROS 2 around it, as far as they join nodes."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.command_lines import remove_ros_arguments
from rtron.sources.code.library_models.common.transforms import BROADCASTERS
from rtron.sources.code.library_models.common.trivial_functions import returning_unknown
from rtron.sources.code.library_models.rclpy.node import (
    ENDPOINT,
    LIFECYCLE_NODE,
    NODE,
    PARAMETER,
    declare_endpoint,
    make_node,
)
from rtron.sources.code.library_models.rclpy.qos import OVERRIDING_CLASSES, library_profiles
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


_DECLARATIONS: Mapping[str, Callable[[AbstractMachine, Arguments], None]] = {
    **{
        f"tf2_ros.{name}": libraries.LIBRARY_DECLARATIONS[name]
        for name in ("TransformListener", "Buffer", *BROADCASTERS)
    },
    "diagnostic_updater.Updater": libraries.LIBRARY_DECLARATIONS["Updater"],
    "interactive_markers.InteractiveMarkerServer": _declare_marker_server,
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
    "rclpy.action.ActionServer": partial(_declare_with_node, DeclarationKind.ACTION_SERVER),
    "rclpy.action.ActionClient": partial(_declare_with_node, DeclarationKind.ACTION_CLIENT),
    "rclpy.wait_for_message.wait_for_message": _wait_for_message,
    "message_filters.Subscriber": partial(_declare_with_node, _SUBSCRIBE),
    **{name: partial(_construct, name, declare) for name, declare in _DECLARATIONS.items()},
}


_PARTS = 3
_FOLDERS = {
    "get_message": {"msg"},
    "get_service": {"srv"},
    "get_action": {"action"},
    "get_interface": {"msg", "srv", "action"},
}


def _interface(folders: set[str], _: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`get_message("std_msgs/msg/String")`."""

    def named(value: av.Value) -> av.Value:
        name = value.value if isinstance(value, av.Scalar) else None
        parts = name.split("/") if isinstance(name, str) else []
        is_full = len(parts) == _PARTS and all(parts) and parts[1] in folders
        return av.MessageType("/".join(parts)) if is_full else av.Unknown("interface")

    return av.map_options(arguments.value(0, "identifier"), named)


ROSIDL: Mapping[str, av.Value] = {
    f"rosidl_runtime_py.utilities.{name}": av.LibraryFunction(name, partial(_interface, folders))
    for name, folders in _FOLDERS.items()
}


def _launch_service(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`launch.LaunchService()`: what it includes, `rtron scan` reads where it is named."""
    why = "what a node launches itself is not followed: name its launch file with --launch too"
    machine.recorder.add_unresolved("launch.LaunchService()", why, arguments.evidence)
    return av.Unknown("LaunchService")


def _create_node(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    return make_node(machine, arguments)


def rclpy_library() -> dict[str, av.Value]:
    """Return what RTron knows of rclpy, for one program."""
    return {
        **{name: av.LibraryFunction(name, call) for name, call in LIBRARY_FUNCTIONS.items()},
        **library_profiles(),
        **ROSIDL,
        **OVERRIDING_CLASSES,
        **dict.fromkeys(("rclpy.node.Node", "rclpy.Node"), NODE),
        **dict.fromkeys(("rclpy.lifecycle.Node", "rclpy.lifecycle.LifecycleNode"), LIFECYCLE_NODE),
        "rclpy.Parameter": PARAMETER,
        "rclpy.create_node": av.LibraryFunction("rclpy.create_node", _create_node),
        "launch.LaunchService": av.LibraryFunction("launch.LaunchService", _launch_service),
        **dict.fromkeys(
            ("rclpy.utilities.remove_ros_args", "rclpy.remove_ros_args"),
            av.LibraryFunction("remove_ros_args", remove_ros_arguments),
        ),
        "rclpy.ok": av.LibraryFunction("rclpy.ok", returning_unknown("ok")),
    }
