"""Libraries of ROS 2 that join a node, in C++ and Python alike: tf2_ros, diagnostic_updater."""

from rtron.sources.code.interpreter.abstract_values.items import listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    NativeClass,
    Text,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.nodes import (
    NAME,
    NodeWords,
    full_name,
    name_of,
    node_among,
    record,
)
from rtron.sources.declaration import DeclarationKind


def library_node(arguments: Arguments) -> Instance | None:
    """Return the node that is among what a library gets."""
    return node_among((*arguments.values, *arguments.keywords.values()))


def own_node(machine: Machine, prefix: str, at: Arguments) -> Instance:
    """Return a node that a library makes for itself; its name ends in what only the run knows.

    Its own arguments name it (tf2_ros: TransformListener); the rest of the process's count for it.
    """
    name = Text((f"__node:={prefix}", Hole("id")))
    words = NodeWords(name=Hole("id"), arguments=listed((Known("-r"), name)))
    node = Instance(NativeClass("node"), {NAME: full_name(machine, words)})
    record(machine, name_of(node), words, at)
    return node


def transforms(
    kind: DeclarationKind, machine: Machine, arguments: Arguments, *, static: bool
) -> None:
    """Record `TransformListener(buffer[, node])`, `TransformBroadcaster(node)`."""
    node = library_node(arguments)
    if node is None and kind is DeclarationKind.SUBSCRIBE:
        node = own_node(machine, "transform_listener_impl_", arguments)
    if node is None:
        endpoints.unknown_owner(machine, "TransformBroadcaster", None, arguments)
    else:
        endpoints.transforms(machine, kind, node, arguments, static=static)


def buffer(machine: Machine, arguments: Arguments) -> None:
    """Record that `tf2_ros::Buffer(clock[, cache_time][, node])` answers tf2_frames for a node."""
    node = library_node(arguments)
    if node is not None:
        kind, type = DeclarationKind.SERVICE, "tf2_msgs/srv/FrameGraph"
        name = Known("tf2_frames")
        endpoints.declare(machine, kind, node, name, type, arguments, implicit=True)


def diagnostics(machine: Machine, arguments: Arguments) -> None:
    """Record `diagnostic_updater::Updater(node)`."""
    node = library_node(arguments)
    if node is not None:
        endpoints.diagnostics(machine, node, arguments)
