"""Libraries of ROS 2 that join a node, in C++ and Python alike: tf2_ros, diagnostic_updater."""

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Instance,
    LibraryClass,
    PartialText,
    Scalar,
    Unknown,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.nodes import (
    NAME_FIELD,
    NodeArguments,
    first_node,
    full_name,
    node_name,
    record_node,
)
from rtron.sources.declaration import DeclarationKind


def node_argument(arguments: Arguments) -> Instance | None:
    """Return the node that is among what a library gets."""
    return first_node(arguments.all_values)


def make_internal_node(machine: AbstractMachine, prefix: str, at: Arguments) -> Instance:
    """Return a node that a library makes for itself; its name ends in what only the run knows.

    Its own arguments name it (tf2_ros: TransformListener); the rest of the process's count for it.
    """
    name = PartialText((f"__node:={prefix}", Unknown("id")))
    words = NodeArguments(name=Unknown("id"), arguments=list_of((Scalar("-r"), name)))
    node = Instance(LibraryClass("node"), {NAME_FIELD: full_name(machine, words)})
    record_node(machine, node_name(node), words, at)
    return node


def declare_transforms(
    kind: DeclarationKind, machine: AbstractMachine, arguments: Arguments, *, static: bool
) -> None:
    """Record `TransformListener(buffer[, node])`, `TransformBroadcaster(node)`."""
    node = node_argument(arguments)
    if node is None and kind is DeclarationKind.SUBSCRIBE:
        node = make_internal_node(machine, "transform_listener_impl_", arguments)
    if node is None:
        endpoints.note_unknown_node(machine, "TransformBroadcaster", None, arguments)
    else:
        endpoints.declare_transforms(machine, kind, node, arguments, static=static)


def declare_buffer(machine: AbstractMachine, arguments: Arguments) -> None:
    """Record that `tf2_ros::Buffer(clock[, cache_time][, node])` answers tf2_frames for a node."""
    node = node_argument(arguments)
    if node is not None:
        kind, type = DeclarationKind.SERVICE, "tf2_msgs/srv/FrameGraph"
        name = Scalar("tf2_frames")
        endpoints.declare_endpoint(machine, kind, node, name, type, arguments, implicit=True)


def declare_diagnostics(machine: AbstractMachine, arguments: Arguments) -> None:
    """Record `diagnostic_updater::Updater(node)`."""
    node = node_argument(arguments)
    if node is not None:
        endpoints.declare_diagnostics(machine, node, arguments)
